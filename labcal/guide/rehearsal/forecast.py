"""The forecast of the errors of points over the working volume, from the plan alone."""

from dataclasses import dataclass

import numpy as np
from jaxtyping import Float64

from labcal.arrays import Mask, PointCovariances, Pose, Vectors3
from labcal.calibrate.budget.expected_covariance import ExpectedCovariance
from labcal.calibrate.dot_decision import MIN_VIEWS, MOST_DOTS
from labcal.calibrate.dot_treatment import DotTreatment
from labcal.cameras.rig_covariance import RigCovariance
from labcal.errors import InputError
from labcal.geometry.poses import transform
from labcal.geometry.rigid_part import without_rigid_part
from labcal.guide.rehearsal.error_scatter import ErrorScatter
from labcal.guide.rehearsal.planned_rig import PlannedRig, directions
from labcal.guide.rehearsal.sources import Sources
from labcal.reconstruct.point_budget import Budget, PointBudget


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
    shape : float64 array, (n, 3, 3)
        The calibration's share where points are brought onto the truth by a rigid motion.
    depth : float64 array, (n, 3)
        Unit vectors of depth: away from the middle of the cameras.
    places, shapes : ErrorScatter
        Of RMS errors in the frame of the first camera, and of those that a rigid alignment leaves.
    covariance : RigCovariance
        Of the cameras, as the calibration will state it.
    dot_places : DotTreatment
        Treatment of the dots by the calibration: freed or declared.
    """

    grid: Vectors3
    seen: Mask
    noise: PointCovariances
    calibration: PointCovariances
    shape: PointCovariances
    depth: Float64[np.ndarray, "n 3"]
    places: ErrorScatter
    shapes: ErrorScatter
    covariance: RigCovariance
    dot_places: DotTreatment

    @property
    def point_mm(self) -> Float64[np.ndarray, " n"]:
        """RMS length of the 3-D error of each point; NaN where not seen."""
        return _length(self.noise + self.calibration)

    @property
    def calibration_point_mm(self) -> Float64[np.ndarray, " n"]:
        """The share of the calibration in it."""
        return _length(self.calibration)

    @property
    def shape_point_mm(self) -> Float64[np.ndarray, " n"]:
        """RMS length of the 3-D error of each point after a rigid alignment of all."""
        return _length(self.noise + self.shape)

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
        """RMS length of the 3-D error over all points that are seen, in the frame of the first camera."""
        return rms(self.point_mm)

    @property
    def shape_mm(self) -> float:
        """RMS length of the 3-D error over all points that are seen, after a rigid alignment."""
        return self.shapes.rms_mm

    def rms_of(self, points: Mask) -> float:
        """Return the RMS error of some of the points, in the frame of the first camera."""
        return rms(self.point_mm[points])

    @property
    def calibration_mm(self) -> float:
        """The share of the calibration in the RMS error in the frame of the first camera."""
        return rms(self.calibration_point_mm)


def rms(values: Float64[np.ndarray, " n"]) -> float:
    """Return the root mean square of the values that are known."""
    known = values[np.isfinite(values)]
    return float(np.sqrt((known**2).mean())) if len(known) else float("nan")


def forecast(planned: PlannedRig, views: list[Pose], sources: Sources) -> Forecast:
    """Return the errors to expect of points that are measured after a calibration from these views.

    Where the plan leaves the treatment of the dots to the calibration, it is the one with the smaller errors,
    as :mod:`~labcal.calibrate.dot_decision` decides of real ones.

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
    if not planned.seen(planned.grid).any():
        raise InputError(
            f"No point of the working volume of the plan '{plan.name}' is seen by all cameras. Move the "
            "volume, or change the distance, the baseline or where the cameras look."
        )
    if plan.shoot.dot_places is not DotTreatment.AUTO:
        return _forecast(planned, views, sources, plan.shoot.dot_places)
    declared = _forecast(planned, views, sources, DotTreatment.DECLARED)
    if sources.print_sigma_mm == 0.0 or not may_free(planned, len(views)):
        return declared
    try:
        freed = _forecast(planned, views, sources, DotTreatment.FREED)
    except InputError:
        return declared
    return freed if freed.calibration_mm < declared.calibration_mm else declared


def may_free(planned: PlannedRig, views: int) -> bool:
    """Tell whether a calibration may free the dots by itself, as far as target and views are concerned."""
    target = planned.plan.target
    return (
        views >= MIN_VIEWS
        and target.count <= MOST_DOTS
        and not target.symmetric_indices(target.indices()[:1])
    )


def _forecast(planned: PlannedRig, views: list[Pose], sources: Sources, dots: DotTreatment) -> Forecast:
    grid, seen = planned.grid, planned.seen(planned.grid)
    expected = _expected(planned, views, sources, dots)
    covariance = with_known_lenses(expected.total, expected.lens, sources.lens_share)
    record = RigCovariance.of(planned.rig.cameras, covariance)
    p = transform(planned.T_first_plan, grid[seen])
    pixels = sources.points.covariances(planned, p)
    rig = planned.rig.model_copy(update={"covariance": record})
    budget = PointBudget.of(rig, p, pixels, Budget.FULL)
    left = without_rigid_part(budget.derivatives(np.arange(len(p))), p)
    noise, calibration, shape = (np.full((len(grid), 3, 3), np.nan) for _ in range(3))
    R = planned.R_plan_first
    noise[seen], calibration[seen] = R @ budget.noise @ R.T, R @ budget.calibration @ R.T
    shape[seen] = R @ (left @ budget.parameters @ left.transpose(0, 2, 1)) @ R.T
    return Forecast(
        grid=grid,
        seen=seen,
        noise=noise,
        calibration=calibration,
        shape=shape,
        depth=directions(planned, grid),
        places=ErrorScatter.of_places(budget),
        shapes=ErrorScatter.of_shape(budget),
        covariance=record,
        dot_places=dots,
    )


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


def _expected(
    planned: PlannedRig, views: list[Pose], sources: Sources, dots: DotTreatment
) -> ExpectedCovariance:
    observations = planned.observations(views, sources.dots)
    freed = dots is DotTreatment.FREED
    of = ExpectedCovariance.of_freed if freed else ExpectedCovariance.of_declared
    return of(planned.state(views), observations, sources.print_sigma_mm)


def _length(covariance: PointCovariances) -> Float64[np.ndarray, " n"]:
    return np.asarray(np.sqrt(np.trace(covariance, axis1=1, axis2=2)))
