"""A print that is off is found again, with the uncertainty that is stated."""

from collections.abc import Callable
from dataclasses import replace

import numpy as np
import pytest
from scipy.stats import chi2

from labcal.calibrate.adjustment.dot_freedom import Constrained
from labcal.calibrate.adjustment.state import Lenses
from labcal.calibrate.handheld import HandheldSettings, calibrate_handheld
from labcal.calibrate.handheld_calibration import HandheldCalibration
from labcal.cameras.camera import Camera
from labcal.cameras.rig import Rig
from labcal.correspond.detections import Detections
from labcal.errors import InputError
from labcal.evaluate.print_shape import agreement
from labcal.targets.grid import DotGrid

See = Callable[..., Detections]
Cameras = dict[str, Camera]
Poses = dict[str, np.ndarray]

NOISE_PX = 0.02
FREE = HandheldSettings(eccentricity_rounds=0, dot_places="freed")
STRETCH, SHEAR, BOW_MM = 2e-3, 1e-3, 0.3


@pytest.fixture
def pinholes(pair: Cameras) -> Cameras:
    return {name: replace(camera, lens="pinhole", dist=np.zeros(5)) for name, camera in pair.items()}


@pytest.fixture
def printed(grid: DotGrid) -> np.ndarray:
    """Where the dots are: stretched, sheared, bowed along x, and each a little off, mm."""
    p = grid.points()
    away = p - p.mean(axis=0)
    p[:, 0] += 0.5 * STRETCH * away[:, 0] + SHEAR * away[:, 1]
    p[:, 1] -= 0.5 * STRETCH * away[:, 1]
    p[:, 2] = -BOW_MM * (away[:, 0] / away[:, 0].max()) ** 2
    p[:, :2] += 0.02 * np.random.default_rng(9).normal(size=(len(p), 2))
    return p


def seen(cameras: Cameras, exact: Detections, printed: np.ndarray, poses: Poses) -> Detections:
    """Return the detections of a print as it is, with noise."""
    q = np.empty_like(exact.position)
    cols = exact.index[:, 0].max() + 1
    dot = exact.index[:, 1] * cols + exact.index[:, 0]
    for view, T in poses.items():
        for name, camera in cameras.items():
            rows = (exact.view == view) & (exact.camera == name)
            q[rows] = camera.project(printed[dot[rows]] @ T[:3, :3].T + T[:3, 3]).q
    noise = NOISE_PX * np.random.default_rng(10).normal(size=q.shape)
    covariance = np.tile(NOISE_PX**2 * np.eye(2), (len(q), 1, 1))
    return replace(exact, position=q + noise, covariance=covariance)


@pytest.fixture
def found(
    see: See, pinholes: Cameras, grid: DotGrid, poses: Poses, printed: np.ndarray
) -> HandheldCalibration:
    dots = seen(pinholes, see(pinholes, grid, poses), printed, poses)
    corner = (dots.index == [4, 3]).all(axis=1) & ~((dots.view == "pose-1") & (dots.camera == "left"))
    return calibrate_handheld(dots.where(~corner), grid, "pinhole", FREE)


def test_the_print_is_found(found: HandheldCalibration, grid: DotGrid, printed: np.ndarray) -> None:
    freed = found.freed
    assert freed is not None
    assert found.rms_px < 1.05 * np.sqrt(2) * NOISE_PX
    assert freed.constrained is Constrained.NOTHING
    # A dot in one picture stays where it is declared.
    assert freed.freed.tolist() == [True] * 19 + [False]
    np.testing.assert_array_equal(freed.place[-1], grid.points()[-1])
    assert (freed.sigma[-1] == 0.0).all()
    # The places agree with the truth up to the gauge, which is taken out of the truth to first order.
    p = grid.points()[:-1]
    away = p - p.mean(axis=0)
    x, y, z = away.T
    o, one = np.zeros_like(x), np.ones_like(x)
    motions = ([one, o, o], [o, one, o], [o, o, one], [-y, x, o], [z, o, -x], [o, -z, y], [x, y, z])
    gauge = np.stack([np.stack(motion, axis=-1).ravel() for motion in motions], axis=-1)
    d_true = (printed - grid.points())[:-1].ravel()
    d_true -= gauge @ np.linalg.lstsq(gauge, d_true, rcond=None)[0]
    off = freed.displacement[:-1].ravel() - d_true
    covariance = freed.covariance[:-1, :, :-1].reshape(off.size, off.size)
    spread, axes = np.linalg.eigh(covariance)
    known = spread > 1e-9 * spread[-1]
    assert known.sum() == off.size - 7
    # Gauge motions of second order are 1e-3 of the displacements, far below the noise.
    square = ((axes[:, known].T @ off) ** 2 / spread[known]).sum()
    assert 0.001 < chi2.sf(square, known.sum()) < 0.999
    alone = [fit.freed for fit in found.fits.values() if fit.freed is not None]
    assert len(alone) == 2
    assert min(agreement(alone)) > 0.9


def test_frontal_views_tell_no_heights(
    see: See, pinholes: Cameras, grid: DotGrid, printed: np.ndarray
) -> None:
    middle = grid.points().mean(axis=0)
    frontal = {}
    for number in range(4):
        c, s = np.cos(0.8 * number), np.sin(0.8 * number)
        T = np.eye(4)
        T[:3, :3] = np.diag([1.0, -1.0, -1.0]) @ np.array([[c, -s, 0], [s, c, 0], [0, 0, 1.0]])
        T[:3, 3] = np.array([0.0, 0.0, 280.0 + 10.0 * number]) - T[:3, :3] @ middle
        frontal[f"pose-{number}"] = T
    left = {"left": pinholes["left"]}
    dots = seen(left, see(left, grid, frontal), printed, frontal)
    settings = replace(FREE, start=Rig.of(left), lenses=Lenses.FIXED)
    freed = calibrate_handheld(dots, grid, "pinhole", settings).freed
    assert freed is not None
    assert Constrained.HEIGHTS in freed.constrained
    assert (freed.place[:, 2] == 0.0).all()
    assert (freed.sigma[:, 2] == 0.0).all()


def test_too_few_pictures_free_nothing(
    see: See, pinholes: Cameras, grid: DotGrid, poses: Poses, printed: np.ndarray
) -> None:
    dots = seen(pinholes, see(pinholes, grid, poses), printed, poses)
    number = np.array([int(view[-1]) for view in dots.view])
    few = dots.where((dots.camera == "left") & ((dots.index[:, 0] + number) % 4 < 2) & (number < 4))
    with pytest.raises(InputError, match="too few to free them"):
        calibrate_handheld(few, grid, "pinhole", FREE)
