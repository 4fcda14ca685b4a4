"""The page of ``labcal evaluate``: the verdict, errors in space, over the volume, and how they are spread."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass

import numpy as np

from labcal.arrays import Pose, Vectors3
from labcal.cameras.camera import Camera
from labcal.correspond.matching import rows_by_name
from labcal.correspond.points import Points
from labcal.errors import InputError
from labcal.evaluate.against_truth import TruthErrors
from labcal.evaluate.own_lengths import LengthErrors
from labcal.evaluate.scored_views import scored_description
from labcal.evaluate.verdict.of_length_errors import length_verdict
from labcal.evaluate.verdict.of_truth_errors import over_limit, truth_verdict
from labcal.evaluate.working_distance import usual_distance
from labcal.geometry.poses import rigid_alignment, transform
from labcal.report.error_histogram import error_histogram
from labcal.report.error_map import error_map
from labcal.report.page.beside import Beside
from labcal.report.page.chart import Chart
from labcal.report.page.document import Page, Section
from labcal.report.page.download import Download, table_download
from labcal.report.page.part import Part
from labcal.report.page.prose import Prose
from labcal.report.page.space_view import SpaceView
from labcal.report.page.statement import Statement
from labcal.report.page.table import Column, PageTable, Side
from labcal.report.page_maker import PageMaker
from labcal.report.space import Space
from labcal.report.target_outline import target_outline
from labcal.targets.places import DotPlaces
from labcal.targets.target import Target
from labcal.wording import counted

_MOST_VIEWS = 60
"""In the table of views."""
_FEWEST = 3
"""Points of a view that its target can be laid onto."""


@dataclass(frozen=True)
class Surroundings:
    """Cameras and target around the points, in the world in which their errors are drawn.

    Attributes
    ----------
    cameras : mapping of str to Camera
        Those of the truth, or of the rig; empty where none is known.
    poses : mapping of str to float64 array, (4, 4)
        ``T_world_target`` by view, mm; of a truth.
    """

    cameras: Mapping[str, Camera]
    poses: Mapping[str, Pose]


def evaluation_page(
    errors: TruthErrors | LengthErrors,
    points: Points,
    target: Target | DotPlaces,
    around: Surroundings,
    maker: PageMaker,
) -> Page:
    """Return the page of the errors of points.

    Parameters
    ----------
    errors : TruthErrors or LengthErrors
    points : Points
        All that were evaluated.
    target : Target or DotPlaces
        What they are dots of.
    around : Surroundings
    maker : PageMaker
    """
    board = target.target if isinstance(target, DotPlaces) else target
    if isinstance(errors, TruthErrors):
        scored = _Scored(errors.points, errors.true_points, errors.error, _IN_SPACE)
        verdict = truth_verdict(errors, _distance(scored, around))
        table, spread = _truth_table(errors), _truth_spread(errors)
        against = "against the known truth"
    else:
        scored = _laid_on(points, errors.views_scored, target)
        verdict = length_verdict(errors, _longest(scored), _distance(scored, around))
        table, spread = _length_table(errors), _length_spread(errors)
        against = "against the target's own lengths"
    outlines = [transform(T, target_outline(board)) for T in _outline_poses(scored, around, target)]
    space = Space(
        around.cameras, outlines, scored.places + scored.error, -scored.error, _labels(scored.points)
    )
    lengths = np.linalg.norm(scored.error, axis=1)
    volume = Chart("error-map", error_map(scored.places, lengths), _OVER_THE_VOLUME, _error_file(scored))
    return Page(
        title=f"Errors of points of {board.name}",
        heading=f"Errors in millimetres, {against}",
        lead=f"{counted(len(scored.points), 'point')} of the target {board.name}, "
        f"{maker.phrase(scored_description(len(errors.views_scored), errors.views_calibrated_on))}.",
        sections=[
            Section("Figures", [Beside((table, spread))]),
            Section("In space", [SpaceView("space", space, scored.description)]),
            Section("Over the volume", [volume]),
            Section("By view", [_view_table(scored)]),
        ],
        provenance=maker.provenance,
        opening=[Statement(verdict, maker.phrase), *maker.notes(errors.warnings)],
    )


_IN_SPACE = (
    "Cameras of the truth with their fields of view, the target in the scored views, and the reconstructed "
    "points. An error vector leads from a point to its true place."
)
_LAID_ON = (
    "The reconstructed points, and the target laid onto them in every view with the least sum of squares. An "
    "error vector leads from a point to its dot on that target."
)
_OVER_THE_VOLUME = (
    "RMS length of the 3-D error in each cell. Errors of noise grow with the distance alone; those that grow "
    "towards a side are of the model."
)


@dataclass(frozen=True)
class _Scored:
    """Points that count, where they should be, and their errors (mm)."""

    points: Points
    places: Vectors3
    error: Vectors3
    description: str


def _laid_on(points: Points, views: Sequence[str], target: Target | DotPlaces) -> _Scored:
    """Return the points of scored views, and the places of the target laid onto those of each view."""
    board = target.target if isinstance(target, DotPlaces) else target
    known = np.isfinite(points.point).all(axis=1) & np.isin(points.view, views)
    numbers = points.index[:, 1] * board.cols + points.index[:, 0]
    if isinstance(target, DotPlaces):
        known &= target.freed()[numbers]
    kept, dots = points.where(known), target.points()[numbers[known]]
    places = np.full(kept.point.shape, np.nan)
    for rows in rows_by_name(kept.view).values():
        if len(rows) < _FEWEST:
            continue
        try:
            places[rows] = transform(rigid_alignment(kept.point[rows], dots[rows]), dots[rows])
        except InputError:  # all on one line
            continue
    laid = np.isfinite(places).all(axis=1)
    kept, places = kept.where(laid), places[laid]
    return _Scored(kept, places, kept.point - places, _LAID_ON)


def _outline_poses(scored: _Scored, around: Surroundings, target: Target | DotPlaces) -> list[Pose]:
    """Return where the target was in each scored view: by the truth, else laid onto the points."""
    board = target.target if isinstance(target, DotPlaces) else target
    poses = []
    for view, rows in rows_by_name(scored.points.view).items():
        if view in around.poses:
            poses.append(np.asarray(around.poses[view], dtype=np.float64))
        elif len(rows) >= _FEWEST:
            numbers = scored.points.index[rows, 1] * board.cols + scored.points.index[rows, 0]
            poses.append(rigid_alignment(scored.places[rows], target.points()[numbers]))
    return poses


def _distance(scored: _Scored, around: Surroundings) -> float | None:
    """Return the median distance of the points from the middle between the cameras, mm."""
    return None if len(scored.places) == 0 else usual_distance(around.cameras.values(), scored.places)


def _longest(scored: _Scored) -> float:
    """Return the longest length between two points of a view, about: the diagonal of their box, mm."""
    sides = [np.ptp(scored.places[rows], axis=0) for rows in rows_by_name(scored.points.view).values()]
    return max((float(np.linalg.norm(side)) for side in sides), default=float("nan"))


def _labels(points: Points) -> list[str]:
    rows = zip(points.view.tolist(), points.index.tolist(), points.flag.tolist(), strict=True)
    return [f"{view}, dot {col}, {row} ({flag})" for view, (col, row), flag in rows]


def _truth_table(errors: TruthErrors) -> PageTable:
    x, y, z = errors.mean_signed_mm
    rows = [
        ["points", str(errors.n)],
        ["mean error in X, Y, Z, with sign", f"{x:+.4f}, {y:+.4f}, {z:+.4f} mm"],
        ["mean length", f"{errors.mae_mm:.4f} mm"],
        ["RMS", f"{errors.rmse_mm:.4f} mm"],
        ["95th percentile", f"{errors.p95_mm:.4f} mm"],
        ["greatest", f"{errors.max_mm:.4f} mm"],
    ]
    if not np.isnan(errors.limit_mm):
        rows.append(["limit of triangulation by exact cameras (RMS)", f"{errors.limit_mm:.4f} mm"])
        rows.append(["RMS over this limit", f"{over_limit(errors):.2f}"])
    if not np.isnan(errors.coverage95):
        rows.append(["points within the stated 95% ellipsoid", f"{100 * errors.coverage95:.1f}%"])
    rows.append(["alignment", errors.alignment])
    caption = f"Errors of {errors.scored}; {counted(errors.not_scored, 'other')} not scored."
    return PageTable("figures-table", caption, [Column("figure", Side.LEFT), Column("value")], rows)


def _truth_spread(errors: TruthErrors) -> Chart:
    marks = {"RMS": errors.rmse_mm, "95th percentile": errors.p95_mm, "limit (RMS)": errors.limit_mm}
    svg = error_histogram(np.linalg.norm(errors.error, axis=1), "length of the error (mm)", "points", marks)
    return Chart("histogram", svg, "How the lengths of the errors are spread.")


def _length_table(errors: LengthErrors) -> PageTable:
    rows = [
        ["lengths", str(errors.n)],
        ["RMS", f"{errors.length_error_mm.rms:.4f} mm"],
        ["greatest", f"{errors.length_error_mm.max:.4f} mm"],
        ["scale", f"{errors.scale_ppm:+.1f} ppm"],
    ]
    caption = "Errors of the lengths between all pairs of dots of a view (VDI/VDE 2634 part 1)."
    return PageTable("figures-table", caption, [Column("figure", Side.LEFT), Column("value")], rows)


def _length_spread(errors: LengthErrors) -> Chart:
    rms = errors.length_error_mm.rms
    marks = {"RMS": rms, "minus RMS": -rms}
    svg = error_histogram(errors.error, "measured minus nominal length (mm)", "lengths", marks)
    return Chart("histogram", svg, "How the errors of lengths are spread.")


def _view_table(scored: _Scored) -> Part:
    length = np.linalg.norm(scored.error, axis=1)
    rows = []
    for view, lines in rows_by_name(scored.points.view).items():
        x, y, z = scored.error[lines].mean(axis=0)
        rms, most = float(np.sqrt((length[lines] ** 2).mean())), float(length[lines].max())
        rows.append(
            [view, str(len(lines)), f"{rms:.4f}", f"{most:.4f}", f"{x:+.4f}", f"{y:+.4f}", f"{z:+.4f}"]
        )
    if not rows:
        return Prose(("No view has three points that its target could be laid onto.",))
    headings = ("points", "RMS, mm", "greatest, mm", "mean in X, mm", "mean in Y, mm", "mean in Z, mm")
    columns = [Column("view", Side.LEFT), *map(Column, headings)]
    caption = "Errors by view."
    if len(rows) > _MOST_VIEWS:
        caption = f"Errors by view: the {_MOST_VIEWS} views with the largest errors of {len(rows)}."
        rows = sorted(rows, key=lambda row: -float(row[2]))[:_MOST_VIEWS]
    return PageTable("views-table", caption, columns, rows)


def _error_file(scored: _Scored) -> Download:
    """Return every error as a table."""
    points = scored.points
    figures = np.round(np.concatenate([scored.places, scored.error], axis=1).T, 5).tolist()
    header = ("view", "col", "row", "X_mm", "Y_mm", "Z_mm", "X_error_mm", "Y_error_mm", "Z_error_mm", "flag")
    columns = (points.view.tolist(), *points.index.T.tolist(), *figures, points.flag.tolist())
    return table_download("errors.csv", header, columns)
