"""The forecast of the errors of points over the working volume, from the plan alone."""

from dataclasses import dataclass

import numpy as np
from jaxtyping import Float64

from labcal.arrays import Mask, PointCovariances, Pose, Vectors3
from labcal.calibrate.budget.expected_covariance import ExpectedCovariance
from labcal.cameras.derivatives import point_derivatives
from labcal.cameras.rig_covariance import RigCovariance
from labcal.errors import InputError
from labcal.geometry.poses import transform
from labcal.guide.rehearsal.dot_noise import DotNoise, facing_sizes
from labcal.guide.rehearsal.planned_rig import PlannedRig, directions
from labcal.guide.rehearsal.rig_plan import RigPlan
from labcal.reconstruct.point_budget import Budget, PointBudget
from labcal.rng import generator

DRAWS = 400
"""Calibrations that are drawn from their covariance, for the range of one."""
_RANGE = (2.5, 97.5)
"""Percentiles."""


@dataclass(frozen=True)
class PointNoise:
    """The noise of the points to be measured: stated, or that of dots of some size that face the cameras.

    Attributes
    ----------
    dots : DotNoise
    radius_mm : float
    sigma_px : float or None
        Standard deviation of each coordinate, where it is stated.
    """

    dots: DotNoise
    radius_mm: float
    sigma_px: float | None

    @classmethod
    def of(cls, plan: RigPlan, dots: DotNoise) -> "PointNoise":
        """Return the noise of points of a plan: as it states, or as of its target's dots."""
        return cls(dots, 0.5 * plan.target.dot_diameter_mm, plan.point_sigma_px)

    def times(self, factor: float) -> "PointNoise":
        """Return noise with a standard deviation that is so many times as large."""
        sigma = None if self.sigma_px is None else factor * self.sigma_px
        return PointNoise(self.dots.times(factor), self.radius_mm, sigma)

    def covariances(self, planned: PlannedRig, p: Vectors3) -> Float64[np.ndarray, "n cameras 2 2"]:
        """Return covariances of the pixels of points, px squared; `p` in the frame of the first camera."""
        if self.sigma_px is not None:
            return np.tile(self.sigma_px**2 * np.eye(2), (len(p), len(planned.cameras), 1, 1))
        found = []
        for camera in planned.cameras:
            by_point = point_derivatives(camera, transform(camera.T_cam_world, p)).by_point
            found.append(self.dots.covariances(facing_sizes(by_point, self.radius_mm)))
        return np.stack(found, axis=1)


@dataclass(frozen=True)
class Sources:
    """Sizes of what makes errors.

    Attributes
    ----------
    dots : DotNoise
        Of the target's dots in the views that calibrate.
    points : PointNoise
        Of the points that are measured then.
    print_sigma_mm : float
    lens_share : float
        Factor of the standard deviations of all lens parameters, 1 as the views determine them.
    """

    dots: DotNoise
    points: PointNoise
    print_sigma_mm: float
    lens_share: float = 1.0

    @classmethod
    def of(cls, plan: RigPlan, dots: DotNoise) -> "Sources":
        """Return the sources of a plan, whose dots have some noise."""
        return cls(dots, PointNoise.of(plan, dots), plan.print_sigma_mm)


@dataclass(frozen=True)
class Forecast:
    """Expected errors of points over the working volume, in the plan's frame.

    Attributes
    ----------
    grid : float64 array, (n, 3)
        Mm.
    seen : bool array, (n,)
        Mask of the points that all cameras see; the others have no error.
    noise, calibration : float64 array, (n, 3, 3)
        Covariances by the points' own pixels and by the calibration, mm squared; NaN where not seen.
    depth : float64 array, (n, 3)
        Unit vectors of depth: away from the middle of the cameras.
    lowest_mm, highest_mm : float
        Range of the RMS error of a single calibration, in 95 of 100.
    covariance : RigCovariance
        Of the cameras, as the calibration will state it.
    """

    grid: Vectors3
    seen: Mask
    noise: PointCovariances
    calibration: PointCovariances
    depth: Float64[np.ndarray, "n 3"]
    lowest_mm: float
    highest_mm: float
    covariance: RigCovariance

    @property
    def point_mm(self) -> Float64[np.ndarray, " n"]:
        """RMS length of the 3-D error of each point; NaN where not seen."""
        return _length(self.noise + self.calibration)

    @property
    def calibration_point_mm(self) -> Float64[np.ndarray, " n"]:
        """The share of the calibration in it."""
        return _length(self.calibration)

    @property
    def depth_mm(self) -> Float64[np.ndarray, " n"]:
        """Standard deviation of each point in depth."""
        total = self.noise + self.calibration
        return np.asarray(np.sqrt(np.einsum("ni,nij,nj->n", self.depth, total, self.depth)))

    @property
    def sideways_mm(self) -> Float64[np.ndarray, " n"]:
        """RMS standard deviation of each point across, of one axis."""
        return np.asarray(np.sqrt(0.5 * np.maximum(self.point_mm**2 - self.depth_mm**2, 0.0)))

    @property
    def rms_mm(self) -> float:
        """RMS length of the 3-D error over all points that are seen."""
        return rms(self.point_mm)

    def rms_of(self, points: Mask) -> float:
        """Return the same of some of the points."""
        return rms(self.point_mm[points])

    @property
    def calibration_mm(self) -> float:
        """The share of the calibration in it."""
        return rms(self.calibration_point_mm)


def rms(values: Float64[np.ndarray, " n"]) -> float:
    """Return the root mean square of the values that are known."""
    known = values[np.isfinite(values)]
    return float(np.sqrt((known**2).mean())) if len(known) else float("nan")


def forecast(planned: PlannedRig, views: list[Pose], sources: Sources) -> Forecast:
    """Return the errors to expect of points that are measured after a calibration from these views.

    Parameters
    ----------
    planned : PlannedRig
    views : list of ndarray, shape (4, 4)
        ``T_first_target`` of the planned views, mm.
    sources : Sources

    Raises
    ------
    InputError
        The views do not determine the cameras, or no point of the volume is seen by all cameras.
    """
    plan = planned.plan
    grid, seen = planned.grid, planned.seen(planned.grid)
    if not seen.any():
        raise InputError(
            f"No point of the working volume of the plan '{plan.name}' is seen by all cameras. Move the "
            "volume, or change the distance, the baseline or where the cameras look."
        )
    expected = _expected(planned, views, sources)
    covariance = with_known_lenses(expected.total, expected.lens, sources.lens_share)
    record = RigCovariance.of(planned.rig.cameras, covariance)
    p = transform(planned.T_first_plan, grid[seen])
    pixels = sources.points.covariances(planned, p)
    rig = planned.rig.model_copy(update={"covariance": record})
    budget = PointBudget.of(rig, p, pixels, Budget.FULL)
    noise, calibration = (np.full((len(grid), 3, 3), np.nan) for _ in range(2))
    R = planned.R_plan_first
    noise[seen], calibration[seen] = R @ budget.noise @ R.T, R @ budget.calibration @ R.T
    lowest, highest = range_of_one(budget)
    return Forecast(grid, seen, noise, calibration, directions(planned, grid), lowest, highest, record)


def with_known_lenses(
    covariance: Float64[np.ndarray, "parameters parameters"], lens: Mask, share: float
) -> Float64[np.ndarray, "parameters parameters"]:
    """Return a covariance in which all standard deviations of lens parameters are smaller by a factor.

    As after an observation of the lenses by other means, which the poses follow (conditional expectation of
    normal variables).

    Parameters
    ----------
    covariance : ndarray, shape (parameters, parameters)
    lens : ndarray of bool, shape (parameters,)
    share : float
        The factor, 0 to 1.
    """
    own = covariance[np.ix_(lens, lens)]
    scale = np.sqrt(np.diagonal(own))
    following = np.linalg.lstsq(own / np.outer(scale, scale), (covariance[lens].T / scale).T, rcond=None)[0]
    known = (following.T / scale) @ own @ (following.T / scale).T
    return np.asarray(covariance - (1.0 - share**2) * 0.5 * (known + known.T))


def _expected(planned: PlannedRig, views: list[Pose], sources: Sources) -> ExpectedCovariance:
    observations = planned.observations(views, sources.dots)
    of = ExpectedCovariance.of_freed if planned.plan.shoot.free_dots else ExpectedCovariance.of_declared
    return of(planned.state(views), observations, sources.print_sigma_mm)


def range_of_one(budget: PointBudget) -> tuple[float, float]:
    """Return within which the RMS error after a single calibration is in 95 of 100.

    All points share the errors of one calibration, so that single ones differ much from their mean.
    """
    random = generator(0, "rehearsal", "range")
    scale = np.sqrt(np.diagonal(budget.parameters))  # so that px, rad and mm are alike
    variance, axes = np.linalg.eigh(budget.parameters / np.outer(scale, scale))
    root = scale[:, None] * axes * np.sqrt(np.maximum(variance, 0.0))
    by = budget.derivatives(np.arange(len(budget))) @ root
    shift = by.reshape(-1, by.shape[2]) @ random.standard_normal((by.shape[2], DRAWS))
    square = (shift**2).sum(axis=0) / len(budget) + np.trace(budget.noise, axis1=1, axis2=2).mean()
    low, high = np.percentile(np.sqrt(square), _RANGE)
    return float(low), float(high)


def _length(covariance: PointCovariances) -> Float64[np.ndarray, " n"]:
    return np.asarray(np.sqrt(np.trace(covariance, axis1=1, axis2=2)))
