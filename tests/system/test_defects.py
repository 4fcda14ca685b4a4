"""Boards with defects and things in the way: the pictures show what the truth says."""

from pathlib import Path

import cv2
import numpy as np
import pytest

from labcal.render.shoot import RenderSettings, render_shoot
from labcal.run.progress import NoProgress
from labcal.scene.catalogue import load_scene
from labcal.shoot.dataset import Shoot
from labcal.shoot.pictures import read_picture
from labcal.shoot.truth import TrueDots, read_true_dots

PLAIN = (
    "cameras.left.size=[320, 240]", "cameras.left.focal_px=350", "cameras.left.principal_px=[160, 119]",
    "cameras.right.size=[320, 240]", "cameras.right.focal_px=352", "cameras.right.principal_px=[159, 120]",
    "noise=off", "photometry.bayer=off", "photometry.format=exr", "photometry.blur_px=0", "spp=64",
    "photometry.fall_off=off",
    "lamps=[{kind: ambient, radiance: 1}]",
)  # fmt: skip
DEFECTS = {
    "bent": ("board.bend.along_x_mm=20", "board.bend.along_y_mm=-10", "board.bend.twist_mm=15"),
    "misprinted": ("board.print_scale=[1.03, 0.98]", "board.print_shear=0.02"),
    "misplaced": ("board.misplacement_mm=2",),
}
DEFECTS["all"] = tuple(override for each in DEFECTS.values() for override in each)
THINGS = (
    "occluders=[{kind: box, centre_mm: [1000, 950, 300], size_mm: [200, 60, 60], turn_deg: [0, 20, 30]}, "
    "{kind: rod, frame: target, from_mm: [560, 330, 12], to_mm: [900, 700, 80], diameter_mm: 14}]"
)

# A rod sends all rays through Embree, so that pictures with and without things differ by the things alone.
OUT_OF_SIGHT = "occluders=[{kind: rod, from_mm: [9000, 1000, 0], to_mm: [9000, 1100, 0], diameter_mm: 9}]"


def rendered(folder: Path, name: str, *overrides: str) -> Shoot:
    scene = load_scene("webcam-plane", (*PLAIN, *overrides))
    return render_shoot(scene, folder / name, RenderSettings(views=1), NoProgress())


def picture(shoot: Shoot, dots: TrueDots) -> np.ndarray:
    return read_picture(shoot.folder / "images" / f"{dots.view}_{dots.camera}.exr").astype(np.float64)


def inked_centroids(shown: np.ndarray, dots: TrueDots, radius: int) -> np.ndarray:
    """Return the centroid of the ink around each true one; light and ink have one brightness each."""
    found = []
    ink = 1.0 - shown / shown.max()  # nothing is brighter than the paper
    for x, y in np.rint(dots.centroid).astype(int):
        v, u = np.mgrid[y - radius : y + radius + 1, x - radius : x + radius + 1]
        weight = ink[v, u]
        found.append([(weight * u).sum() / weight.sum(), (weight * v).sum() / weight.sum()])
    return np.array(found)


@pytest.mark.parametrize("name", DEFECTS)
def test_dots_of_a_board_with_defects_lie_where_the_truth_says(tmp_path: Path, name: str) -> None:
    shoot = rendered(tmp_path, "shoot", *DEFECTS[name], "board.dark=[0, 0, 0]")
    plain = rendered(tmp_path, "plain", "spp=1")
    for dots, without in zip(read_true_dots(shoot.folder), read_true_dots(plain.folder), strict=True):
        assert dots.visible.all()
        moved = np.linalg.norm(dots.centroid - without.centroid, axis=1)
        assert np.sqrt((moved**2).mean()) > 0.3
        error = inked_centroids(picture(shoot, dots), dots, radius=5) - dots.centroid
        assert np.sqrt((error**2).sum(axis=1).mean()) < 0.02
        z = error.mean(axis=0) / (error.std(axis=0) / np.sqrt(len(error)))
        assert (np.abs(z) < 4).all()


def test_what_is_hidden_in_the_picture_is_not_visible_in_the_truth(tmp_path: Path) -> None:
    shoot, free = rendered(tmp_path, "shoot", THINGS), rendered(tmp_path, "free", OUT_OF_SIGHT)
    for dots in read_true_dots(shoot.folder):
        changed = picture(shoot, dots) != picture(free, dots)
        hidden = []
        for q in outlines(dots):
            inside = np.zeros(changed.shape, dtype=np.uint8)
            cv2.fillPoly(inside, [np.rint(16 * q).astype(np.int32)], 1, shift=4)
            hidden.append(
                [changed[inside == 1].any(), changed[cv2.dilate(inside, np.ones((3, 3))) == 1].any()]
            )
        surely, perhaps = np.array(hidden).T
        assert surely.sum() >= 8
        assert not dots.visible[surely].any()
        assert dots.visible[~perhaps].all()
        assert (perhaps & ~surely).sum() <= 4


def outlines(dots: TrueDots) -> np.ndarray:
    """Return the dots' outlines shrunk a little, so that pixels inside belong to the dot alone."""
    camera = load_scene("webcam-plane", PLAIN).true_cameras()[dots.camera]
    angle = np.linspace(0.0, 2.0 * np.pi, 40, endpoint=False)
    circle = 15.0 * np.stack([np.cos(angle), np.sin(angle), 0.0 * angle], axis=-1)
    q = camera.project(dots.point[:, None, :] + circle).q
    middle = q.mean(axis=1, keepdims=True)
    radius = np.linalg.norm(q - middle, axis=-1, keepdims=True)
    return middle + (q - middle) * (radius - 0.8) / radius


def test_the_same_bytes_with_two_workers_and_the_scene_in_the_truth(tmp_path: Path) -> None:
    overrides = (
        *PLAIN,
        *DEFECTS["all"],
        "board.gloss_roughness=0.2",
        "board.unevenness=0.03",
        THINGS,
        "spp=4",
    )
    spot = "lamps=[{kind: spot, centre_mm: [700, 500, 2000], look_at_mm: [1000, 1000, 200], intensity: 1e6, "
    ring = "{kind: ring, centre_mm: [720, 640, 1900], look_at_mm: [1000, 1000, 200], inner_diameter_mm: 200, "
    lamps = (spot + "cutoff_deg: 20, beam_deg: 5}, " + ring + "outer_diameter_mm: 420, radiance: 3}]",)
    scene = load_scene("webcam-plane", (*overrides, *lamps))
    one = render_shoot(scene, tmp_path / "one", RenderSettings(views=1), NoProgress())
    two = render_shoot(scene, tmp_path / "two", RenderSettings(views=1, workers=2), NoProgress())
    for path in sorted(one.folder.rglob("*.*")):
        if path.name != "run.json":
            assert path.read_bytes() == (two.folder / path.relative_to(one.folder)).read_bytes()
    assert load_scene(str(one.folder / "truth" / "scene.yaml")) == scene
