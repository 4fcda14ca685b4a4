"""Pictures of a moving target, against truth that no renderer takes part in."""

from dataclasses import replace

import numpy as np
import pytest

from labcal.render import laboratories
from labcal.render.irradiance import Case, render_light
from labcal.render.laboratories import Laboratories
from labcal.render.variant import MONO, renderer
from labcal.scene.catalogue import load_scene
from labcal.scene.model import Scene, least_samples, samples_per_pass
from labcal.scene.motion import ShutterTimes
from labcal.scene.plan import planned_takes
from labcal.scene.subframes import subframes
from labcal.scene.take import Take
from labcal.scene.truth import true_dots
from labcal.scene.views import planned_views
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


def rendered(scene: Scene, *takes: Take) -> list[np.ndarray]:
    with renderer(MONO) as mi:
        return [render_light(Laboratories(mi, scene), Case(take, 0)) for take in takes]


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
    true = true_dots(SPARSE, take)
    assert true.visible.all()
    (light,) = rendered(scene, take)
    error = grey_centroids(light, true.centroid) - true.centroid
    assert np.sqrt((error**2).sum(axis=1).mean()) < 0.02
    z = error.mean(axis=0) / (error.std(axis=0) / np.sqrt(len(error)))
    assert (np.abs(z) < 4.0).all()
    # What the test is about: without the shutter's times the truth would be elsewhere.
    if shutter:
        unread = true_dots(SPARSE, replace(take, shutter=replace(take.shutter, readout_s=0.0)))
        assert np.abs(true.centroid - unread.centroid).max() > 1.0


def test_a_moving_board_is_smeared_along_its_movement_alone() -> None:
    scene = moving_scene("motion.velocity_mm_s=[2000, 0, 0]", "spp=16")
    sharp, smeared = rendered(scene, left_take(scene, 0.0), left_take(scene, 0.01))
    across, along = (np.abs(np.diff(sharp, axis=axis)).max() for axis in (0, 1))
    assert np.abs(np.diff(smeared[60:180, 90:240], axis=1)).max() < 0.5 * along
    assert np.abs(np.diff(smeared[60:180, 90:240], axis=0)).max() > 0.5 * across


def test_the_rays_are_shared_among_the_subframes(monkeypatch: pytest.MonkeyPatch) -> None:
    scene = moving_scene("motion.velocity_mm_s=[600, 0, 0]", "spp=64", "shutter=rolling", "readout_ms=30")
    take = left_take(scene, 0.01)
    frames = subframes(take, SPARSE)
    traced: list[tuple[int, int, int]] = []
    trace = laboratories.Laboratory.trace

    def counted(self, camera, first_row, samples, seed):  # type: ignore[no-untyped-def]  # noqa: ANN001, ANN202
        traced.append((first_row, self.band_rows, samples))
        return trace(self, camera, first_row, samples, seed)

    monkeypatch.setattr(laboratories.Laboratory, "trace", counted)
    rendered(scene, take)
    height = take.device.size[1]
    rays = np.zeros(height)
    for first_row, rows, samples in traced:
        rays[first_row : first_row + rows] += samples
    assert len(traced) >= len(frames.seconds) > 10
    assert (rays >= 64).all()
    assert sum(rows * samples for _, rows, samples in traced) < 4 * 64 * height


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
        one = Laboratories(mi, scene).of_size((32, 24))
        assert Laboratories(mi, scene.model_copy()).of_size((32, 24)) is one
        assert Laboratories(mi, scene).of_size((32, 12)) is not one
        assert Laboratories(mi, brighter).of_size((32, 24)) is not one
    with renderer("llvm_ad_rgb") as mi:
        assert Laboratories(mi, scene).of_size((32, 24)) is not one


@pytest.mark.parametrize(
    ("wanted", "samples"), [(0.02, 1), (1.0, 1), (1.01, 2), (5.0, 8), (9.0, 16), (16.5, 32), (100.0, 112)]
)
def test_the_least_samples_are_some_that_passes_make_up(wanted: float, samples: int) -> None:
    assert least_samples(wanted) == samples
    assert samples % samples_per_pass(samples) == 0


def test_a_shutter_is_that_of_its_scene() -> None:
    scene = moving_scene("shutter=rolling", "readout_ms=25")
    take = planned_takes(scene, planned_views(scene, 0), 0).takes[0]
    assert take.shutter == ShutterTimes(take.shutter.exposure_s, 0.025, 240)
    assert take.shutter.exposure_s == pytest.approx(0.010)
