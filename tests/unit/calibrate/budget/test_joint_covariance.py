"""The stated covariance of a calibration against calibrations of many simulated sets."""

from dataclasses import dataclass, replace
from functools import cache

import numpy as np
import pytest
from scipy.spatial.transform import Rotation
from scipy.stats import chi2

from labcal.calibrate.adjustment.observations import Observations
from labcal.calibrate.adjustment.rounds import Adjusted, adjust_in_rounds
from labcal.calibrate.adjustment.state import Freedom, Lenses, RigState
from labcal.calibrate.budget.error_sources import ErrorSources
from labcal.cameras.camera import Camera
from labcal.cameras.parameter_derivatives import parameter_count
from labcal.geometry.poses import pose
from labcal.targets.grid import DotGrid

NOISE_PX = 0.05
TARGET = DotGrid(
    name="small", cols=9, rows=7, pitch_x_mm=25.0, pitch_y_mm=25.0, dot_diameter_mm=8.0, rings=None,
    margin_mm=15.0,
)  # fmt: skip
FIXED = Freedom(Lenses.FREE, np.zeros((3 * TARGET.count, 0)))
SETS = 12


def cameras() -> tuple[Camera, ...]:
    turned = Rotation.from_rotvec([0.01, 0.22, 0.005]).as_matrix()
    place = pose(turned, -turned @ np.array([220.0, 3.0, 5.0]))
    dist = (-0.2, 0.05, 4e-4, -3e-4, 0.0), (-0.18, 0.04, -3e-4, 2e-4, 0.0)
    return tuple(
        Camera([[f, 0.0, 645.0], [0.0, f, 474.0], [0.0, 0.0, 1.0]], "brown5", d, T, (1280, 960))
        for f, d, T in zip((900.0, 910.0), dist, (np.eye(4), place), strict=True)
    )


@dataclass(frozen=True)
class Simulated:
    """A set of views, its adjustment, and what it states of its own errors."""

    truth: RigState
    adjusted: Adjusted
    observations: Observations
    sources: ErrorSources

    @property
    def covariance(self) -> np.ndarray:
        count = parameter_count(self.truth.cameras)
        return self.sources.total(self.adjusted.spread[:count, :count])

    def square(self, covariance: np.ndarray) -> float:
        """Return the squared errors of the cameras in units of a covariance."""
        off: list[float] = []
        for number, (found, true) in enumerate(
            zip(self.adjusted.state.cameras, self.truth.cameras, strict=True)
        ):
            off += [*np.subtract(found.intrinsics, true.intrinsics), *(found.dist - true.dist)]
            if number:
                T, true_T = found.T_cam_world, true.T_cam_world
                off += [*Rotation.from_matrix(T[:3, :3] @ true_T[:3, :3].T).as_rotvec()]
                off += [*(T[:3, 3] - true_T[:3, 3])]
        return float(np.array(off) @ np.linalg.solve(covariance, off))


def drawn(seed: int, print_mm: float, views: int, lens: str = "brown5") -> Simulated:
    rng = np.random.default_rng([7, seed])
    dots = TARGET.points()
    poses: list[np.ndarray] = []
    while len(poses) < views:
        R = np.diag([1.0, -1.0, -1.0]) @ Rotation.from_rotvec(0.35 * rng.standard_normal(3)).as_matrix()
        at = rng.uniform([-130.0, -130.0, 700.0], [250.0, 130.0, 1000.0])
        T = pose(R, at - R @ dots.mean(axis=0))
        seen = [camera.project(dots @ T[:3, :3].T + T[:3, 3]).q for camera in cameras()]
        if all(camera.in_picture(q).all() for camera, q in zip(cameras(), seen, strict=True)):
            poses.append(T)
    printed = dots.copy()
    printed[:, :2] += print_mm * rng.standard_normal((len(dots), 2))
    truth = RigState(cameras(), np.stack(poses), printed)
    n = 2 * views * len(dots)
    blank = Observations(
        np.repeat([0, 1], n // 2), np.tile(np.repeat(np.arange(views), len(dots)), 2),
        np.tile(np.arange(len(dots)), 2 * views), np.zeros((n, 2)),
        np.tile(NOISE_PX**2 * np.eye(2), (n, 1, 1)),
    )  # fmt: skip
    observations = replace(blank, q=truth.residuals(blank) + NOISE_PX * rng.standard_normal((n, 2)))
    known = tuple(
        camera if lens == "brown5" else replace(camera, lens=lens, dist=np.array([*camera.dist[:2], 0, 0, 0]))
        for camera in cameras()
    )
    start = RigState(known, truth.T_world_target, dots)
    adjusted = adjust_in_rounds(start, observations, FIXED, np.ones(len(dots)), 0)
    return Simulated(truth, adjusted, observations, ErrorSources.of(adjusted, observations, None))


@cache
def sets(print_mm: float) -> tuple[Simulated, ...]:
    return tuple(drawn(seed, print_mm, 8) for seed in range(SETS))


def bounds(count: int) -> tuple[float, float]:
    low, high = chi2.ppf([5e-4, 0.9995], count)
    return float(low), float(high)


@pytest.mark.parametrize("print_mm", [0.0, 0.1])
def test_cameras_scatter_as_stated(print_mm: float) -> None:
    found = sets(print_mm)
    low, high = bounds(SETS * len(found[0].covariance))
    assert low < sum(one.square(one.covariance) for one in found) < 1.1 * high  # sources are estimates


def test_an_uneven_print_makes_covariances_of_noise_alone_too_small() -> None:
    found = sets(0.1)
    count = len(found[0].covariance)
    _, high = bounds(SETS * count)
    assert sum(one.square(one.adjusted.spread[:count, :count]) for one in found) > 1.2 * high


def test_the_size_of_the_prints_errors_is_found() -> None:
    uneven = np.array([one.sources.print_sigma_mm for one in sets(0.1)])
    assert uneven.mean() == pytest.approx(0.1, rel=0.05)
    assert uneven.std() < 0.02
    # Of an even one as much as the noise of dots in all pictures lets pass for it: 0.05 px are 0.05 mm.
    assert max(one.sources.print_sigma_mm for one in sets(0.0)) < 0.02


def test_noise_is_told_from_the_print() -> None:
    noise = [
        one.sources.noise_factor * (NOISE_PX**2 + one.adjusted.scatter_px**2) / NOISE_PX**2
        for one in sets(0.1)
    ]
    assert np.mean(noise) == pytest.approx(1.0, abs=0.03)


def test_views_of_a_right_lens_agree() -> None:
    z = [(one.sources.views.ratio - 1.0) / one.sources.views.sigma for one in sets(0.0)]
    assert abs(np.mean(z)) < 3.3 / np.sqrt(SETS)
    assert np.sum(np.square(z)) < chi2.ppf(0.9995, SETS)


def test_views_through_a_lens_that_is_too_simple_disagree() -> None:
    found = [drawn(seed, 0.0, 14, "brown-k1k2").sources.views for seed in range(2)]
    assert min((views.ratio - 1.0) / views.sigma for views in found) > 5.0
    assert min(views.factor for views in found) > 2.0


def test_stated_variances_that_are_too_large_are_made_right() -> None:
    one = drawn(0, 0.0, 8)
    wide = replace(one.observations, covariance=1.6 * one.observations.covariance)
    adjusted = adjust_in_rounds(one.adjusted.state, wide, FIXED, np.ones(TARGET.count), 0)
    assert adjusted.prior_width is one.adjusted.prior_width
    sources = ErrorSources.of(adjusted, wide, None)
    assert sources.noise_factor == pytest.approx(one.sources.noise_factor / 1.6, rel=0.05)
    np.testing.assert_allclose(
        np.diagonal(sources.total(adjusted.spread)), np.diagonal(one.covariance), rtol=0.15
    )
