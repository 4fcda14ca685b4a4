"""Errors of reconstructed points against the truth of a rendered shoot."""

from collections.abc import Collection, Mapping
from dataclasses import dataclass, field
from typing import TYPE_CHECKING, Literal

import numpy as np

from labcal.arrays import Mask, Pose, Vectors3
from labcal.cameras.triangulation import triangulation_limit
from labcal.correspond.detections import Detections
from labcal.correspond.matching import Matches, match
from labcal.correspond.points import Points
from labcal.errors import InputError
from labcal.evaluate.aligned_budget import PointOrigin, aligned_covariance
from labcal.evaluate.distance_coverage import distance_coverage
from labcal.evaluate.scored_views import OfScoredViews, ScoredPart, ScoredViews
from labcal.evaluate.shape_coverage import ShapeCoverage, shape_coverage
from labcal.evaluate.statistics import ErrorStatistics, coverage, error_statistics
from labcal.geometry.covariances import positive_definite
from labcal.geometry.hull import inside_hull
from labcal.geometry.poses import rigid_alignment, transform
from labcal.run.json_text import IN_JSON, InJson
from labcal.shoot.dataset import Shoot
from labcal.shoot.manifest import Role
from labcal.shoot.truth import Truth, read_true_dots, read_truth
from labcal.wording import counted, listed

if TYPE_CHECKING:
    import matplotlib.figure
    import pandas

_HULL_TOLERANCE_MM = 1e-3

Alignment = Literal["none", "rigid"]
ALIGNMENTS: tuple[Alignment, ...] = ("none", "rigid")


@dataclass(frozen=True, eq=False, repr=False)
class TruthErrors(OfScoredViews, ErrorStatistics):
    """The JSON document of ``labcal evaluate`` where the truth is known.

    Examples
    --------
    >>> import numpy as np
    >>> from labcal import TruthErrors
    >>> from labcal.evaluate.scored_views import ScoredPart
    >>> error = np.array([[0.1, 0.0, 0.0], [0.0, 0.0, 0.2]])
    >>> figures = (2, (0.05, 0.0, 0.1), 0.15, 0.158, 0.195, 0.2, 0.1, 0.5)
    >>> from labcal import examples
    >>> points = examples.points().where([0, 1])
    >>> TruthErrors(*figures, "none", "all points", 0, ScoredPart(2, ("a",), 0), error, points)
    TruthErrors(n=2, rmse=0.158 mm, limit=0.1 mm, max=0.2 mm, alignment=none)
    """

    limit_mm: float
    """RMS error of triangulating the same detections with exactly known cameras; NaN without detections.

    A method that knows more than the pixels, as that all points lie on one plane, may stay below it.
    """
    coverage95: float
    """Share of points within the 95% ellipsoid that the method states; NaN where it states none.

    After a rigid alignment the ellipsoids of a rig, and of a method that was fitted to a target held in the
    hand, are those without the errors that move all points
    together, where rig and detections are given; else those of the points as they are, which are too large.
    """
    alignment: Alignment
    """`rigid` where the model's world is not the truth's, as with a hand-held target."""
    scored: str
    """Description of the scored points."""
    not_scored: int
    """Reconstructed points that do not count: trained on, outside the trained hull, or without a solution."""
    scored_views: ScoredPart = field(metadata={IN_JSON: InJson.FLAT})
    """The views that are scored; its fields are also those of the errors."""
    error: Vectors3 = field(metadata={IN_JSON: InJson.ABSENT})
    """Predicted minus true of each point that counts, mm; not in the JSON document."""
    points: Points = field(metadata={IN_JSON: InJson.ABSENT})
    """The points that count, as they were reconstructed; not in the JSON document."""
    T_true_model: Pose = field(default_factory=lambda: np.eye(4), metadata={IN_JSON: InJson.ABSENT})
    """The rigid motion that brought the points onto the truth, mm; not in the JSON document."""
    coverage95_distances: float = float("nan")
    """Share of distances of two points within 95% of their truth by sigmas from the joint covariance of the
    rig; NaN without rig and detections."""
    coverage95_planes: float = float("nan")
    """The same of the planes through the points of each view, in the frame of the first camera."""
    coverage95_motions: float = float("nan")
    """The same of the rigid motions of the target from each view to the next one."""
    n_planes: int = 0
    """Planes that were scored. All share the errors of one calibration: they are alike."""
    n_motions: int = 0
    """Motions that were scored, as alike as the planes."""

    @property
    def true_points(self) -> Vectors3:
        """The true places of the points that count, (n, 3), mm, in the world of the truth."""
        return np.asarray(transform(self.T_true_model, self.points.point) - self.error)

    def to_pandas(self) -> "pandas.DataFrame":
        """Return a table with a line for each point that counts: its view and dot, its error in mm, its flag.

        Raises
        ------
        DeviceError
            pandas is not installed.
        """
        from labcal.evaluate.error_tables import truth_errors_frame  # noqa: PLC0415 -- pandas is optional

        return truth_errors_frame(self)

    def plot(self) -> "matplotlib.figure.Figure":
        """Draw a histogram of the lengths of the errors, with their RMS and the limit of triangulation, mm.

        Examples
        --------
        >>> import numpy as np
        >>> from labcal import TruthErrors, examples
        >>> from labcal.evaluate.scored_views import ScoredPart
        >>> part, points = ScoredPart(2, ("a",), 0), examples.points().where([0, 1])
        >>> error = np.array([[0.1, 0.0, 0.0], [0.0, 0.0, 0.2]])
        >>> figures = (2, (0.05, 0.0, 0.1), 0.15, 0.158, 0.195, 0.2, 0.1, 0.5)
        >>> errors = TruthErrors(*figures, "none", "all points", 0, part, error, points)
        >>> errors.plot().axes[0].get_xlabel()
        'length of the error (mm)'
        """
        from labcal.evaluate.error_figure import error_figure  # noqa: PLC0415 -- imports matplotlib

        marks = {"RMS": self.rmse_mm, "limit of triangulation (RMS)": self.limit_mm}
        length = np.linalg.norm(self.error, axis=1)
        return error_figure(length, "length of the error (mm)", "points", marks)

    def _summary(self) -> Mapping[str, object]:
        return {
            "n": self.n,
            "rmse": f"{self.rmse_mm:.3g} mm",
            "limit": f"{self.limit_mm:.3g} mm",
            "max": f"{self.max_mm:.3g} mm",
            "alignment": self.alignment,
        }


def errors_against_truth(
    points: Points,
    shoot: Shoot,
    detections: Detections | None,
    alignment: Alignment | None = None,
    learned: Collection[str] | None = None,
    origin: PointOrigin | None = None,
) -> TruthErrors:
    """Compare points with the true positions of the dots.

    Where the shoot has test views at known places, only their dots within the hull of the trained dots count;
    of a hand-held target, only views that were not learned from, where there are such.

    Parameters
    ----------
    points : Points
    shoot : Shoot
        Its folder holds the truth.
    detections : Detections or None
        What the points came from, for the limit.
    alignment : {"none", "rigid"}, optional
        Whether to bring the points onto the truth by a rigid motion first. Where left out, only for a
        hand-held target, whose world is the first camera's frame.
    learned : collection of str, optional
        Names of the views that were learned from. Where left out, those to train on, if there are others.
    origin : PointOrigin, optional
        What the points were reconstructed with. With it and the detections the coverage after an alignment
        is that of what the alignment leaves of the calibration's errors.

    Raises
    ------
    InputError
        The points are not of this shoot, or none of them counts.
    """
    truth = read_truth(shoot.folder)
    _require_same_cameras(shoot, "truth.json", truth.cameras)
    unknown = sorted(set(points.view.tolist()) - set(truth.views))
    if unknown:
        raise InputError(
            f"The points hold view '{unknown[0]}', which the shoot {shoot.folder} does not have."
        )
    places = _true_places(shoot)
    true = _true_points(points.view, points.index, places)
    by_role = learned is None
    views = ScoredViews.by_role(points.view, shoot) if by_role else ScoredViews.of(points.view, learned)
    counts, scored = _scored(points, true, shoot, views)
    counts &= np.isfinite(points.point).all(axis=1) & np.isfinite(true).all(axis=1)
    if not counts.any():
        raise InputError(f"None of the {counted(len(points), 'point')} can be scored; {scored} would be.")
    kept, true = points.where(counts), true[counts]
    alignment = alignment or ("none" if shoot.nominal_poses() else "rigid")
    predicted, covariance = kept.point, kept.covariance
    T_true_model = np.eye(4)
    if alignment == "rigid":
        T_true_model = rigid_alignment(true, predicted)
        R = T_true_model[:3, :3]
        if origin is not None and detections is not None:
            left = aligned_covariance(kept, origin, detections)
            covariance = covariance if left is None else left
        predicted, covariance = transform(T_true_model, predicted), R @ covariance @ R.T
    figures = error_statistics(predicted, true)
    shapes = _shapes(kept, true, origin, detections, truth)
    return TruthErrors(
        n=figures.n,
        mean_signed_mm=figures.mean_signed_mm,
        mae_mm=figures.mae_mm,
        rmse_mm=figures.rmse_mm,
        p95_mm=figures.p95_mm,
        max_mm=figures.max_mm,
        limit_mm=float("nan") if detections is None else _limit(kept, shoot, truth, places, detections),
        coverage95=coverage(predicted - true, covariance),
        coverage95_distances=float("nan")
        if origin is None or not origin.triangulated or detections is None
        else distance_coverage(kept, true, origin, detections),
        alignment=alignment,
        scored=scored,
        not_scored=int((~counts).sum()),
        scored_views=ScoredPart.of(kept, views),
        error=predicted - true,
        points=kept,
        T_true_model=T_true_model,
        coverage95_planes=shapes.planes,
        coverage95_motions=shapes.motions,
        n_planes=shapes.n_planes,
        n_motions=shapes.n_motions,
    )


def _shapes(
    kept: Points, true: Vectors3, origin: PointOrigin | None, detections: Detections | None, truth: Truth
) -> ShapeCoverage:
    """Return the coverage of planes and motions of a rig's points, in the frame of its first camera."""
    if origin is None or not origin.triangulated or detections is None:
        return ShapeCoverage()
    first = next(iter(origin.rig.cameras))
    own = first in truth.cameras and np.allclose(origin.rig.camera(first).T_cam_world, np.eye(4))
    if not own:
        return ShapeCoverage()
    in_first = transform(truth.cameras[first].camera().T_cam_world, true)
    return shape_coverage(kept, in_first, origin, detections)


def _require_same_cameras(shoot: Shoot, file: str, cameras: Collection[str]) -> None:
    """Raise unless a file of the truth belongs to the cameras of the shoot.

    Raises
    ------
    InputError
        A camera of the shoot is not in it, or another one is.
    """
    missing, strange = set(shoot.cameras) - set(cameras), set(cameras) - set(shoot.cameras)
    if missing or strange:
        what = f"lacks camera '{min(missing)}'" if missing else f"has a camera '{min(strange)}'"
        raise InputError(
            f"The truth of the shoot {shoot.folder} is not its own: {file} {what}, unlike the manifest, "
            f"whose cameras are {listed(shoot.cameras)}. Copy the shoot again."
        )


Places = dict[tuple[str, int, int], list[float]]
"""True positions of dots, mm, by view, col and row."""


def _true_places(shoot: Shoot) -> Places:
    """Return the position of every dot when the first camera saw it, which may differ from the design."""
    places: Places = {}
    pictures = read_true_dots(shoot.folder)
    _require_same_cameras(shoot, "dots.csv", {picture.camera for picture in pictures})
    for picture in pictures:
        for (col, row), point in zip(picture.index.tolist(), picture.point.tolist(), strict=True):
            places.setdefault((picture.view, col, row), point)
    return places


def _true_points(view: np.ndarray, index: np.ndarray, places: Places) -> Vectors3:
    """Return the true positions of dots; NaN for those without truth."""
    unknown = [np.nan] * 3
    keys = zip(view.tolist(), *index.T.tolist(), strict=True)
    return np.array([places.get(key, unknown) for key in keys], dtype=np.float64).reshape(-1, 3)


def _held_out(views: ScoredViews) -> str:
    """Return a mask of scored points of a hand-held target, and its description."""
    if not views.others:
        return "all points"
    return "points of views to test on" if views.calibrated_on is None else "points of views held out"


def _scored(points: Points, true: Vectors3, shoot: Shoot, views: ScoredViews) -> tuple[Mask, str]:
    """Return a mask of scored points, and its description."""
    nominal = shoot.nominal_poses()
    tested = {view.name for view in shoot.views(Role.TEST)}
    trained = [view.name for view in shoot.views(Role.TRAIN) if view.name in nominal]
    if not (tested and trained):
        return views.holds(points.view), _held_out(views)
    p_target = shoot.target.points()
    hull_of = np.concatenate([transform(nominal[name], p_target) for name in trained])
    of_test = np.isin(points.view, sorted(tested))
    return of_test & inside_hull(
        true, hull_of, _HULL_TOLERANCE_MM
    ), "points of test views within the trained hull"


def _limit(kept: Points, shoot: Shoot, truth: Truth, places: Places, detections: Detections) -> float:
    """Return the RMS error with exactly known cameras, from the covariances of the detections."""
    matches = match(detections, shoot.cameras)
    wanted = {
        (view, *index)
        for view, index in zip(kept.view.tolist(), map(tuple, kept.index.tolist()), strict=True)
    }
    chosen = matches.where(_contained(matches, wanted))
    chosen = chosen.where(np.asarray(positive_definite(chosen.covariance).all(axis=1)))
    if len(chosen) == 0:
        return float("nan")
    true = _true_points(chosen.view, chosen.index, places)
    cameras = [truth.cameras[name].camera() for name in shoot.cameras]
    bound = triangulation_limit(cameras, true, chosen.covariance)
    return float(np.sqrt(np.trace(bound, axis1=1, axis2=2).mean()))


def _contained(matches: Matches, wanted: set[tuple[str, int, int]]) -> Mask:
    keys = zip(matches.view.tolist(), map(tuple, matches.index.tolist()), strict=True)
    return np.array([(view, *index) in wanted for view, index in keys], dtype=bool)
