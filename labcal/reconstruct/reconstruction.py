"""Points in space from matched dots, by a fitted method or by a rig."""

from collections import Counter
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from typing import TYPE_CHECKING

import numpy as np

from labcal.calibrate.agreement.exchange.by_rays import refuse_exchanged_by_rays
from labcal.calibrate.eccentricity import (
    CorrectedEccentricity,
    centred,
    eccentricities_of_matches,
    has_discs,
)
from labcal.calibrate.systematic_residual import SystematicResidual, systematic_residual
from labcal.calibrate.triangulation_check import TriangulationCheck
from labcal.calibrate.triangulation_residuals import TriangulationResiduals
from labcal.cameras.calibration_record import CalibrationRecord
from labcal.cameras.rig import Rig
from labcal.cameras.rig_file import read_rig
from labcal.cameras.triangulation import triangulate
from labcal.correspond.boards_points import with_known_lengths
from labcal.correspond.detections import Detections
from labcal.correspond.matching import Matches, match, require_on_target
from labcal.correspond.points import PointFlag, Points
from labcal.errors import InputError
from labcal.estimators.model import Model
from labcal.estimators.model_file import ModelKind, load_model, model_kind, training_views
from labcal.estimators.valid_points import predicted, within_sense
from labcal.paths import AnyPath
from labcal.public_object import HtmlTable, PublicObject
from labcal.reconstruct.point_budget import Budget, PointBudget, budget_of_a_method
from labcal.reconstruct.target_scale import TargetScale, target_scale
from labcal.targets.target import Target

if TYPE_CHECKING:
    import matplotlib.figure
    import pandas
    import xarray


_FEWEST_OTHERS = 0.4
"""Share of points in other views, below which views that are flagged count in the test of all pictures."""


def load_reconstructor(path: AnyPath, method: object | None = None) -> Model | Rig:
    """Read a MODEL: what ``labcal fit`` wrote, or a ``rig.json``.

    Parameters
    ----------
    path : str or os.PathLike
    method : str, type or object, optional
        The method of one's own that a model was fitted with; see
        :func:`~labcal.estimators.model_file.load_model`.

    Raises
    ------
    InputError
        The file is neither, or is damaged; or a method is named, or is not, and should not, or should be.
    """
    if model_kind(path) is not ModelKind.RIG:
        return load_model(path, method)
    if method is not None:
        raise InputError(f"{path} is a rig, which has no method. Name none.")
    return read_rig(path)


def calibration_views(path: AnyPath) -> tuple[str, ...]:
    """Return the names of the views that a MODEL comes from; empty where that is not known.

    Raises
    ------
    InputError
        The file is neither a model nor a rig, or is damaged.
    """
    return read_rig(path).calibrated_on if model_kind(path) is ModelKind.RIG else training_views(path)


@dataclass(frozen=True, eq=False, repr=False)
class Reconstruction(PublicObject):
    """Points, and the eccentricity that was subtracted from the centroids that they come from.

    Examples
    --------
    >>> from labcal import examples, load_target, pipeline
    >>> target = load_target(examples.TARGET)
    >>> found = pipeline.reconstruct(examples.rig(), examples.detections(), target)
    >>> found
    Reconstruction(points=704, ok=704, median_residual=0.00933 px, budget=noise, warnings=0)
    """

    points: Points
    eccentricity: CorrectedEccentricity | None
    """None if it was not corrected: of corners, which have none, or of dots whose target is not known."""
    miss_px: float | None
    """Median triangulation residual of dots, px; infinite if their rays do not intersect; None if the model
    has no cameras."""
    check: TriangulationCheck | None
    """Comparison of this with the value expected from the calibration; None if the model has no cameras."""
    warnings: tuple[str, ...] = ()
    """Warnings in words."""
    budget: PointBudget | None = None
    """The shares of noise and calibration in the covariances, line by line; None if the model has no rig."""
    systematic: SystematicResidual | None = None
    """The part of the triangulation residuals that changes of whole pictures explain; None where the target
    or the rig's covariance is not known."""
    scale: TargetScale | None = None
    """Size of the reconstructed target; None where either is not known."""

    def save(self, path: AnyPath, *, force: bool = False) -> None:
        """Write the points as ``points.csv``, which :meth:`Points.load` reads.

        Raises
        ------
        OutputError
            The file exists and `force` is not set, or it cannot be written.
        """
        self.points.save(path, force=force)

    def to_pandas(self) -> "pandas.DataFrame":
        """Return the points as a table; as :meth:`Points.to_pandas`."""
        return self.points.to_pandas()

    def to_xarray(self) -> "xarray.Dataset":
        """Return the points as arrays; as :meth:`Points.to_xarray`."""
        return self.points.to_xarray()

    def plot(self) -> "matplotlib.figure.Figure":
        """Draw the points in space; as :meth:`Points.plot`."""
        return self.points.plot()

    def _html_tables(self) -> Sequence[HtmlTable]:
        flags = Counter(self.points.flag.tolist())
        return [
            HtmlTable(("flag", "points"), [[flag, str(count)] for flag, count in flags.items()]),
            HtmlTable(("warnings",), [[warning] for warning in self.warnings]),
        ]

    def _summary(self) -> Mapping[str, object]:
        summary: dict[str, object] = {"points": len(self.points), "ok": int(self.points.ok.sum())}
        if self.miss_px is not None:
            summary["median_residual"] = f"{self.miss_px:.3g} px"
        if self.budget is not None:
            summary["budget"] = self.budget.kind.value
        return {**summary, "warnings": len(self.warnings)}


def reconstruct_points(model: Model | Rig, detections: Detections, target: Target | None = None) -> Points:
    """Return the points of :func:`reconstruct_centres`; without a target, those of the centroids."""
    return reconstruct_centres(model, detections, target).points


def reconstruct_centres(
    model: Model | Rig, detections: Detections, target: Target | None, budget: Budget | None = None
) -> Reconstruction:
    """Return the points of all dots that every camera of the model measured.

    Parameters
    ----------
    model : Model or Rig
        A fitted method gives points in the stage's world, with the covariances that it states; a rig
        triangulates in its own world, with covariances from the pixels' and from its own.
    detections : Detections
    target : Target, optional
        If given, the eccentricity of centroids is corrected, with the cameras of the rig, or with those of a
        method that was fitted to centres. The pose of the target comes from the points of the centroids.
    budget : Budget, optional
        The sources of errors in the covariances of a rig's points; all that the rig knows if left out.

    Raises
    ------
    InputError
        A budget is named for a fitted method, or the full one for a rig that states no covariance; a dot is
        not on the target or its points are not, a camera of the model is missing, its pictures are of another
        size or exchanged, or no dot was seen by all cameras.
    """
    if target is not None:
        require_on_target(detections, target)
    cameras = tuple(model.cameras)
    matches = match(detections, cameras)
    if len(matches) == 0:
        raise InputError(f"No dot was measured by all of the cameras {', '.join(cameras)} in the same view.")
    if isinstance(model, Rig):
        _require_sizes(detections, {name: record.size for name, record in model.cameras.items()})
        found = _by_rig(model, matches, target, budget)
        return replace(found, points=within_sense(found.points))
    if budget is not None:
        raise budget_of_a_method()
    _require_sizes(detections, dict(zip(cameras, model.image_sizes, strict=True)))
    found = _by_method(model, matches, target)
    return replace(found, points=within_sense(found.points))


def _require_sizes(detections: Detections, sizes: dict[str, tuple[int, int]]) -> None:
    for camera, expected in sizes.items():
        given = detections.picture_size(camera)
        if given != tuple(expected):
            raise InputError(
                f"Camera '{camera}' was calibrated with pictures of {expected[0]} x {expected[1]}, but "
                f"these are {given[0]} x {given[1]}. Calibrate again with pictures of this size."
            )


def _by_rig(rig: Rig, matches: Matches, target: Target | None, wanted: Budget | None) -> Reconstruction:
    if len(rig.cameras) == 1:
        raise InputError("A rig with one camera cannot reconstruct points; calibrate with two or more.")
    cameras, corrected, centres = [rig.camera(name) for name in matches.cameras], None, False
    refuse_exchanged_by_rays(cameras, matches)
    if target is not None:
        try:
            matches, corrected = centred(cameras, matches, target)
            centres = True
        except InputError:
            if not _inconsistent(rig.calibration):
                raise  # else it is the rig that puts points nowhere near the target
    found = triangulate(cameras, matches.q, matches.covariance)
    residuals = TriangulationResiduals.at(cameras, matches, found)
    check = TriangulationCheck.of(residuals, matches, rig.calibration)
    systematic = None
    if rig.covariance is not None and centres:
        record, rest = rig.calibration or CalibrationRecord(), ~np.isin(matches.view, check.views)
        if rest.mean() < _FEWEST_OTHERS:  # the camera has changed, not what some views show
            rest[:] = True
        point = found.point[rest]
        systematic = systematic_residual(cameras, matches.where(rest), point, rig.covariance.matrix, record)
    changed = systematic is not None and systematic.beyond_chance
    doubtful = np.isin(matches.view, check.views) | _inconsistent(rig.calibration) | changed
    flag = np.where(residuals.outlying | doubtful, PointFlag.MODEL_MISFIT.value, PointFlag.OK.value)
    flag = np.where(found.ok, flag, PointFlag.NO_SOLUTION.value)
    budget = PointBudget.of(rig, found.point, matches.covariance, wanted)
    covariance = found.covariance
    if budget.kind is Budget.FULL:
        covariance = budget.noise + budget.calibration
    return Reconstruction(
        Points(matches.view, matches.index, found.point, covariance, flag),
        corrected,
        residuals.typical_px,
        check,
        budget=budget,
        systematic=systematic,
        scale=None
        if target is None
        else target_scale(
            rig, with_known_lengths(matches, target), budget, target, found.ok & ~residuals.outlying
        ),
    )


def _by_method(model: Model, matches: Matches, target: Target | None) -> Reconstruction:
    corrected, outlying, typical_px, check = None, np.zeros(len(matches), dtype=bool), None, None
    if model.resected is not None:
        refuse_exchanged_by_rays(model.resected, matches)
        if target is not None:
            roughly = np.asarray(model.estimator.predict(matches.X)[:, :3])
            eccentricity = eccentricities_of_matches(model.resected, matches, roughly, target)
            matches = replace(matches, q=matches.q - eccentricity)
            corrected = CorrectedEccentricity.of(eccentricity) if has_discs(target) else None
        residuals = TriangulationResiduals.of(model.resected, matches)
        check = TriangulationCheck.of(residuals, matches, model.calibration)
        outlying, typical_px = residuals.outlying | np.isin(matches.view, check.views), residuals.typical_px
    point, covariance = predicted(model, matches)
    misfit = model.misfit or _inconsistent(model.calibration)
    flag = np.where(outlying | misfit, PointFlag.MODEL_MISFIT.value, PointFlag.OK.value)
    flag = np.where(model.box.holds(point), flag, PointFlag.EXTRAPOLATED.value)
    flag = np.where(np.isfinite(point).all(axis=1), flag, PointFlag.NO_SOLUTION.value)
    points = Points(matches.view, matches.index, point, covariance, flag)
    return Reconstruction(points, corrected, typical_px, check)


def _inconsistent(calibration: CalibrationRecord | None) -> bool:
    """Tell whether the calibration views of the cameras contradict each other."""
    return calibration is not None and bool(calibration.inconsistent)
