import json
import os
from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from labcal.cameras.record import CameraRecord
from labcal.errors import InputError, OutputError
from labcal.render.shoot import RenderSettings, render_shoot
from labcal.run.progress import NoProgress
from labcal.scene.catalogue import load_scene
from labcal.scene.model import Scene
from labcal.shoot.exr import read_exr_texts
from labcal.shoot.manifest import Role
from labcal.shoot.pictures import read_picture
from labcal.shoot.truth import TrueDots, read_true_dots, read_truth

SMALL = (
    "cameras.left.size=[320, 240]",
    "cameras.left.focal_px=350",
    "cameras.left.principal_px=[160, 119]",
    "cameras.right.size=[320, 240]",
    "cameras.right.focal_px=352",
    "cameras.right.principal_px=[159, 120]",
    "spp=16",
)
PLAIN = (
    "noise=off",
    "photometry.bayer=off",
    "photometry.format=exr",
    "photometry.blur_px=0",
    "photometry.fall_off=off",
)


def small_scene(*overrides: str) -> Scene:
    return load_scene("webcam-plane", (*SMALL, *overrides))


def files(folder: Path) -> dict[str, bytes]:
    """Return every file of a shoot but run.json, by path."""
    return {
        path.relative_to(folder).as_posix(): path.read_bytes()
        for path in sorted(folder.rglob("*"))
        if path.is_file() and path.name != "run.json"
    }


def grey_centroids(picture: np.ndarray, dots: TrueDots, radius: int) -> np.ndarray:
    """Weigh pixels around each true centroid by how much darker they are than the window's border."""
    found = np.full(dots.centroid.shape, np.nan)
    for number, (x, y) in enumerate(np.rint(dots.centroid).astype(int)):
        window = picture[y - radius : y + radius + 1, x - radius : x + radius + 1].astype(np.float64)
        v, u = np.mgrid[y - radius : y + radius + 1, x - radius : x + radius + 1].astype(np.float64)
        border = np.ones(window.shape, dtype=bool)
        border[1:-1, 1:-1] = False
        plane = np.stack([u, v, np.ones_like(u)], axis=-1)
        background = plane @ np.linalg.lstsq(plane[border], window[border], rcond=None)[0]
        weight = 1.0 - window / background
        found[number] = (weight * u).sum() / weight.sum(), (weight * v).sum() / weight.sum()
    return found


def test_the_same_bytes_twice_and_with_two_workers(tmp_path: Path) -> None:
    scene = small_scene("spp=4")
    once = render_shoot(scene, tmp_path / "once", RenderSettings(), NoProgress())
    again = render_shoot(scene, tmp_path / "again", RenderSettings(), NoProgress())
    two = render_shoot(scene, tmp_path / "two", RenderSettings(workers=2), NoProgress())
    other = render_shoot(scene, tmp_path / "other", RenderSettings(seed=1), NoProgress())
    assert set(files(once.folder)) == {
        ".labcal-made",
        "shoot.json",
        "truth/scene.yaml",
        "truth/truth.json",
        "truth/dots.csv",
        *(
            f"images/{view}_{camera}.jpg"
            for view in ("train", "test-shifted")
            for camera in ("left", "right")
        ),
    }
    assert files(once.folder) == files(again.folder)
    assert files(once.folder) == files(two.folder)
    assert files(once.folder)["images/train_left.jpg"] != files(other.folder)["images/train_left.jpg"]


class Interrupted(NoProgress):
    """The user presses Ctrl-C after the second picture."""

    steps = 0

    def advance(self, steps: int = 1) -> None:
        self.steps += steps
        if self.steps == 2:
            raise KeyboardInterrupt


def test_an_interrupted_run_goes_on_where_it_stopped(tmp_path: Path) -> None:
    scene, folder = small_scene("spp=4", "photometry.format=png"), tmp_path / "shoot"
    with pytest.raises(KeyboardInterrupt):
        render_shoot(scene, folder, RenderSettings(), Interrupted())
    assert not folder.exists()
    unfinished = tmp_path / "shoot.unfinished" / "images"
    kept = unfinished / "train_left.png"
    os.utime(kept, ns=(1, 1))
    (unfinished / ".labcal-part-abc").write_bytes(b"half a picture")
    (unfinished / "train_right.png").unlink()
    with pytest.raises(OutputError, match="another command"):
        render_shoot(scene, folder, RenderSettings(seed=1), NoProgress())
    shoot = render_shoot(scene, folder, RenderSettings(), NoProgress())
    assert (shoot.folder / "images" / "train_left.png").stat().st_mtime_ns == 1
    whole = render_shoot(scene, tmp_path / "whole", RenderSettings(), NoProgress())
    assert files(shoot.folder) == files(whole.folder)
    assert not (tmp_path / "shoot.unfinished").exists()
    assert "train_left.png" not in json.loads((folder / "run.json").read_text())["picture_seconds"]


@pytest.mark.parametrize("colour", ["on", "off"])
def test_grey_centroids_lie_on_the_true_ones(tmp_path: Path, colour: str) -> None:
    scene = small_scene(*PLAIN, f"photometry.bayer={colour}", "spp=64")
    shoot = render_shoot(scene, tmp_path / "shoot", RenderSettings(views=1), NoProgress())
    for dots in read_true_dots(shoot.folder):
        picture = read_picture(shoot.folder / "images" / f"{dots.view}_{dots.camera}.exr")
        assert picture.dtype == np.float32
        assert dots.visible.all()
        grey = picture if colour == "off" else picture.mean(axis=-1)
        assert 0.7 < grey.max() < 0.8  # photometry.white is 0.75
        error = grey_centroids(grey, dots, radius=5) - dots.centroid
        assert np.sqrt((error**2).sum(axis=1).mean()) < 0.02
        z = error.mean(axis=0) / (error.std(axis=0) / np.sqrt(len(error)))
        assert (np.abs(z) < 4).all()


def test_delivered_colour_pictures_keep_the_centroids(tmp_path: Path) -> None:
    scene = load_scene("webcam-plane", ("noise=off",))
    shoot = render_shoot(scene, tmp_path / "shoot", RenderSettings(views=1), NoProgress())
    for dots in read_true_dots(shoot.folder):
        picture = read_picture(shoot.folder / "images" / f"{dots.view}_{dots.camera}.jpg")
        assert picture.shape == (480, 640, 3)
        assert picture.max() < 255
        error = grey_centroids(picture.mean(axis=-1), dots, radius=9) - dots.centroid
        assert np.sqrt((error**2).sum(axis=1).mean()) < 0.02


def test_an_exr_names_its_camera_and_its_picture(tmp_path: Path) -> None:
    scene = small_scene("photometry.format=exr", "photometry.exposure_ms=4", "spp=1")
    shoot = render_shoot(scene, tmp_path / "shoot", RenderSettings(views=1), NoProgress())
    for name, record in read_truth(shoot.folder).cameras.items():
        texts = read_exr_texts(shoot.folder / "images" / f"train_{name}.exr")
        assert CameraRecord.model_validate_json(texts["labcal:camera"]) == record
        picture = json.loads(texts["labcal:picture"])
        assert (picture["view"], picture["camera"], picture["exposure_ms"]) == ("train", name, 4.0)
        assert picture["full_scale_radiance"] > 0.0


def test_a_picture_of_16_bits_is_rendered_and_detected(tmp_path: Path, labcal: Callable[..., Any]) -> None:
    folder, table = tmp_path / "shoot", tmp_path / "detections.csv"
    options = ("--set", "photometry.format=tif", "--set", "photometry.bits=16", "--spp", 4, "--views", 1)
    assert labcal("render", "webcam-plane", "-o", folder, "--workers", 1, *options).status == 0
    picture = read_picture(folder / "images" / "train_left.tif")
    assert picture.dtype == np.uint16
    assert len(np.unique(picture)) > 1000  # more than 8 bits could hold
    assert labcal("detect", folder, "-o", table, "--workers", 1).document["indexed"] == 2


def test_the_manifest_tells_nothing_of_the_truth(tmp_path: Path) -> None:
    scene = load_scene("webcam-handheld", (*SMALL, "spp=1", "placement.spread_mm=[50, 50, 50]"))
    shoot = render_shoot(scene, tmp_path / "shoot", RenderSettings(views=2), NoProgress())
    assert [view.name for view in shoot.views()] == ["pose-01", "pose-02"]
    assert len(shoot.views(Role.TRAIN)) == 2
    assert shoot.nominal_poses() == {}
    text = (shoot.folder / "shoot.json").read_text()
    assert all(word not in text for word in ("lens", "dist", "focal", "T_cam_world", "scene"))
    truth = read_truth(shoot.folder)
    assert truth.cameras["left"].lens == "brown5"
    assert set(truth.views) == {"pose-01", "pose-02"}


@pytest.mark.parametrize(
    ("overrides", "settings"),
    [
        (("cameras.left.dist=[-0.9, 0, 0, 0, 0]",), {}),
        ((), {"spp": 0}),
        ((), {"views": 0}),
        ((), {"workers": 0}),
    ],
)
def test_what_cannot_be_rendered_leaves_nothing_behind(
    tmp_path: Path, overrides: tuple[str, ...], settings: dict[str, int]
) -> None:
    with pytest.raises(InputError):
        render_shoot(small_scene(*overrides), tmp_path / "shoot", RenderSettings(**settings), NoProgress())
    assert list(tmp_path.iterdir()) == []


def test_a_shoot_is_not_replaced_unasked(tmp_path: Path) -> None:
    (tmp_path / "shoot").mkdir()
    (tmp_path / "shoot" / "mine.txt").write_text("mine")
    with pytest.raises(OutputError, match="`force=True`"):
        render_shoot(small_scene("spp=1"), tmp_path / "shoot", RenderSettings(), NoProgress())
    assert (tmp_path / "shoot" / "mine.txt").read_text() == "mine"
    with pytest.raises(OutputError, match="no mark of labcal, so another program"):
        render_shoot(small_scene("spp=1"), tmp_path / "shoot", RenderSettings(force=True), NoProgress())
    assert (tmp_path / "shoot" / "mine.txt").read_text() == "mine"
    (tmp_path / "shoot" / "mine.txt").unlink()
    for _ in range(2):
        render_shoot(small_scene("spp=1"), tmp_path / "shoot", RenderSettings(force=True), NoProgress())
    assert (tmp_path / "shoot" / "shoot.json").is_file()
