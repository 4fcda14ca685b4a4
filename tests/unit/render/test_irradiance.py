"""Pictures of a moving target, against truth that no renderer takes part in."""

from dataclasses import replace

import numpy as np
import pytest

from labcal.render import laboratories
from labcal.render.irradiance import Case, render_light
from labcal.render.laboratories import Laboratories
from labcal.render.laboratory import Draw, Laboratory, Rays
from labcal.render.variant import MONO, renderer
from labcal.scene.catalogue import load_scene
from labcal.scene.model import Scene
from labcal.scene.plan import planned_takes
from labcal.scene.print import TruePrint
from labcal.scene.subframes import subframes
from labcal.scene.take import Take
from labcal.scene.truth import true_dots
from labcal.scene.views import planned_views
from labcal.shoot.truth import TrueDots
from labcal.targets.grid import DotGrid, Rings

SPARSE = DotGrid(
    name="sparse",
    cols=6,
    rows=5,
    pitch_x_mm=140.0,
    pitch_y_mm=175.0,
    dot_diameter_mm=50.0,
    ring_outer_diameter_mm=60.0,
    ring_inner_diameter_mm=20.0,
    rings=Rings(origin=(1, 1), x=(4, 1), y=(1, 3)),
    margin_mm=100.0,
)
"""Few large dots, far apart, so that a window holds a smeared dot and nothing else."""
WINDOW = 12
SMALL = ("cameras.left.size=[320, 240]", "cameras.left.focal_px=350", "cameras.left.principal_px=[160, 119]")


def moving_scene(*overrides: str) -> Scene:
    return load_scene("webcam-plane", (*SMALL, "photometry.bayer=off", *overrides)).model_copy(
        update={"target": SPARSE}
    )


def left_take(scene: Scene, exposure_s: float) -> Take:
    take = planned_takes(scene, planned_views(scene, 0), 0).takes[0]
    return replace(take, shutter=replace(take.shutter, exposure_s=exposure_s))


def seen(scene: Scene, take: Take) -> TrueDots:
    return true_dots(scene, TruePrint.of(scene.target, scene.board, 0), take)


def rendered(scene: Scene, *takes: Take) -> list[np.ndarray]:
    with renderer(MONO) as mi:
        return [render_light(Laboratories(mi, scene, 0), Case(take, 0)) for take in takes]


def grey_centroids(picture: np.ndarray, centroids: np.ndarray) -> np.ndarray:
    """Weigh pixels around each true centroid by how much darker they are than the board around."""
    found = np.full(centroids.shape, np.nan)
    for number, (x, y) in enumerate(np.rint(centroids).astype(int)):
        here = (slice(y - WINDOW, y + WINDOW + 1), slice(x - WINDOW, x + WINDOW + 1))
        window = picture[here].astype(np.float64)
        v, u = (axis[here].astype(np.float64) for axis in np.mgrid[: picture.shape[0], : picture.shape[1]])
        border = np.ones(window.shape, dtype=bool)
        border[2:-2, 2:-2] = False
        plane = np.stack([u, v, np.ones_like(u)], axis=-1)
        background = plane @ np.linalg.lstsq(plane[border], window[border], rcond=None)[0]
        weight = 1.0 - window / background
        found[number] = (weight * u).sum() / weight.sum(), (weight * v).sum() / weight.sum()
    return found


@pytest.mark.parametrize(
    ("shutter", "exposure_s", "spp"),
    [
        ((), 0.01, 96),
        (("shutter=rolling", "readout_ms=30"), 0.01, 96),
        (("shutter=rolling", "readout_ms=30"), 0.0, 32),
    ],
)
def test_grey_centroids_of_a_moving_board_lie_on_the_true_ones(
    shutter: tuple[str, ...], exposure_s: float, spp: int
) -> None:
    scene = moving_scene(
        "motion.velocity_mm_s=[600, 400, 300]", "motion.rotation_deg_s=[60, 20, 90]", f"spp={spp}", *shutter
    )
    take = left_take(scene, exposure_s)
    true = seen(scene, take)
    assert true.visible.all()
    (light,) = rendered(scene, take)
    error = grey_centroids(light, true.centroid) - true.centroid
    assert np.sqrt((error**2).sum(axis=1).mean()) < 0.02
    z = error.mean(axis=0) / (error.std(axis=0) / np.sqrt(len(error)))
    assert (np.abs(z) < 4.0).all()
    # What the test is about: without the shutter's times the truth would be elsewhere.
    if shutter:
        unread = seen(scene, replace(take, shutter=replace(take.shutter, readout_s=0.0)))
        assert np.abs(true.centroid - unread.centroid).max() > 1.0


def test_a_moving_board_is_smeared_along_its_movement_alone() -> None:
    scene = moving_scene("motion.velocity_mm_s=[2000, 0, 0]", "spp=16", "photometry.blur_px=0")
    sharp, smeared = rendered(scene, left_take(scene, 0.0), left_take(scene, 0.01))
    across, along = (np.abs(np.diff(sharp, axis=axis)).max() for axis in (0, 1))
    assert np.abs(np.diff(smeared[60:180, 90:240], axis=1)).max() < 0.5 * along
    assert np.abs(np.diff(smeared[60:180, 90:240], axis=0)).max() > 0.5 * across


def test_the_rays_are_shared_among_the_subframes(monkeypatch: pytest.MonkeyPatch) -> None:
    scene = moving_scene(
        "motion.velocity_mm_s=[600, 0, 0]",
        "spp=64",
        "shutter=rolling",
        "readout_ms=30",
        "photometry.blur_px=0",
    )
    take = left_take(scene, 0.01)
    frames = subframes(take, SPARSE)
    height = take.device.size[1]
    rays, calls = np.zeros(height), 0
    trace = laboratories.Laboratory.trace

    def counted(self: Laboratory, camera: Rays, rows: slice, draw: Draw) -> np.ndarray:
        nonlocal calls
        calls += 1
        rays[rows] += draw.count
        return trace(self, camera, rows, draw)

    monkeypatch.setattr(laboratories.Laboratory, "trace", counted)
    rendered(scene, take)
    assert calls >= len(frames.seconds) > 10
    assert (rays >= 64).all()
    assert rays.mean() < 2 * 64


def test_a_shared_laboratory_leaves_no_mark() -> None:
    scene = moving_scene("spp=4")
    first, other = (
        take for take in planned_takes(scene, planned_views(scene, 0), 0).takes if take.camera == "left"
    )
    laboratories._laboratory.cache_clear()
    (alone,) = rendered(scene, first)
    laboratories._laboratory.cache_clear()
    after = rendered(scene, other, first)[1]
    np.testing.assert_array_equal(alone, after)
    assert laboratories._laboratory.cache_info().misses == 1


def test_laboratories_are_told_apart_by_scene_variant_and_size() -> None:
    scene, brighter = moving_scene("spp=4"), moving_scene("spp=4", "board.dark=[0.2, 0.2, 0.2]")
    laboratories._laboratory.cache_clear()
    with renderer(MONO) as mi:
        one = Laboratories(mi, scene, 0).of_size((32, 24))
        assert Laboratories(mi, scene.model_copy(), 0).of_size((32, 24)) is one
        assert Laboratories(mi, scene, 0).of_size((32, 12)) is not one
        assert Laboratories(mi, brighter, 0).of_size((32, 24)) is not one
    with renderer("llvm_ad_rgb") as mi:
        assert Laboratories(mi, scene, 0).of_size((32, 24)) is not one


def test_a_picture_does_not_depend_on_how_many_rows_are_traced_at_once(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    scene = moving_scene("spp=6")
    take = left_take(scene, 0.0)
    (whole,) = rendered(scene, take)
    monkeypatch.setattr("labcal.render.laboratory.RAYS_AT_ONCE", 7 * 6 * 320)
    np.testing.assert_array_equal(whole, rendered(scene, take)[0])


@pytest.mark.parametrize(
    "extra",
    [
        "occluders=[{kind: rod, from_mm: [9000, 1000, 0], to_mm: [9000, 1100, 0], diameter_mm: 9}]",
        "board.bend.along_x_mm=0.000000001",
    ],
)
def test_panels_and_mitsubas_own_intersections_give_the_same_picture(extra: str) -> None:
    """What is no rectangle, far away or hardly bent, sends all rays through Embree."""
    pictures = []
    for overrides in ((), (extra,)):
        scene = load_scene("webcam-plane", (*SMALL, "photometry.bayer=off", "spp=16", *overrides))
        (picture,) = rendered(scene, left_take(scene, 0.0))
        pictures.append(picture)
    difference = np.abs(pictures[1] - pictures[0])
    assert np.median(difference) < 1e-6 * pictures[0].max()
    assert (difference > 1e-3 * pictures[0].max()).mean() < 0.01  # on edges, where one sample falls over
