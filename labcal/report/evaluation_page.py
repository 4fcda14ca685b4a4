"""The page of ``labcal evaluate``: the verdict, errors in space, over the volume, and how they are spread."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass

import numpy as np

from labcal.arrays import Pose
from labcal.cameras.camera import Camera
from labcal.correspond.matching import rows_by_name
from labcal.correspond.points import Points
from labcal.evaluate.against_truth import TruthErrors
from labcal.evaluate.own_lengths import LengthErrors
from labcal.evaluate.reprojection import Reprojected
from labcal.evaluate.scored_views import scored_description
from labcal.evaluate.verdict.of_length_errors import length_verdict
from labcal.evaluate.verdict.of_truth_errors import truth_verdict
from labcal.evaluate.working_distance import usual_distance
from labcal.geometry.poses import rigid_alignment, transform
from labcal.report.error_map import error_map
from labcal.report.evaluation_figures import (
    error_file,
    labels,
    length_spread,
    length_table,
    truth_spread,
    truth_table,
    view_table,
)
from labcal.report.page.beside import Beside
from labcal.report.page.chart import Chart
from labcal.report.page.document import Page, Section
from labcal.report.page.prose import Prose
from labcal.report.page.space_view import SpaceView
from labcal.report.page.statement import Statement
from labcal.report.page_maker import PageMaker
from labcal.report.residual_map import residual_magnification, residual_map
from labcal.report.scored_points import FEWEST, ScoredPoints, laid_on
from labcal.report.space import Space
from labcal.report.target_outline import target_outline
from labcal.targets.places import DotPlaces
from labcal.targets.target import Target
from labcal.wording import counted


@dataclass(frozen=True)
class Surroundings:
    """Cameras and target around the points, in the world in which their errors are drawn.

    Attributes
    ----------
    cameras : mapping of str to Camera
        Those of the truth, or of the rig; empty where none is known.
    poses : mapping of str to float64 array, (4, 4)
        ``T_world_target`` by view, mm; of a truth.
    residuals : sequence of Reprojected
        Of the points in the pictures, where rig and dots are known.
    """

    cameras: Mapping[str, Camera]
    poses: Mapping[str, Pose]
    residuals: Sequence[Reprojected] = ()


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
        scored = ScoredPoints(errors.points, errors.true_points, errors.error, _IN_SPACE)
        verdict = truth_verdict(errors, _distance(scored, around))
        table, spread = truth_table(errors), truth_spread(errors)
        against = "against the known truth"
    else:
        scored = laid_on(points, errors.views_scored, target)
        verdict = length_verdict(errors, _longest(scored), _distance(scored, around))
        table, spread = length_table(errors), length_spread(errors)
        against = "against the target's own lengths"
    outlines = [transform(T, target_outline(board)) for T in _outline_poses(scored, around, target)]
    space = Space(
        around.cameras, outlines, scored.places + scored.error, -scored.error, labels(scored.points, board)
    )
    lengths = np.linalg.norm(scored.error, axis=1)
    volume = Chart(
        "error-map", error_map(scored.places, lengths), _OVER_THE_VOLUME, error_file(scored, board)
    )
    return Page(
        title=f"Errors of points of {board.name}",
        heading=f"Errors in millimetres, {against}",
        lead=f"{counted(len(scored.points), 'point')} of the target {board.name}, "
        f"{maker.phrase(scored_description(len(errors.views_scored), errors.views_calibrated_on))}.",
        sections=[
            Section("Figures", [Beside((table, spread))]),
            Section("In space", [SpaceView("space", space, scored.description)]),
            Section("Over the volume", [volume]),
            *_residual_sections(around.residuals),
            Section("By view", [view_table(scored)]),
        ],
        provenance=maker.provenance,
        opening=[Statement(verdict, maker.phrase), *maker.notes(errors.warnings)],
    )


_IN_SPACE = (
    "Cameras of the truth with their fields of view, the target in the scored views, and the reconstructed "
    "points. An error vector leads from a point to its true place."
)
_RESIDUALS = (
    "Images of the points by the cameras of the rig minus the measured dots. A point lies where its rays "
    "meet best, so that only what keeps rays from meeting is seen. Thick arrows are means of cells: those "
    "that point the same way as their neighbours show a wrong lens or a camera that has moved."
)
_OVER_THE_VOLUME = (
    "RMS length of the 3-D error in each cell. Errors of noise grow with the distance alone; those that grow "
    "towards a side are of the model."
)


def _residual_sections(residuals: Sequence[Reprojected]) -> list[Section]:
    """Return the residuals over the pictures, where they are known."""
    if not residuals:
        return []
    every = np.concatenate([one.residual for one in residuals])
    times = residual_magnification(every, max(one.size[0] for one in residuals))
    charts = []
    for one in residuals:
        none = np.zeros(len(one.q), dtype=bool)
        svg = residual_map(one.camera, one.q, one.residual, none, one.size, times)
        charts.append(
            Chart(f"residuals-{one.camera}", svg, f"{one.camera}: {len(one.q)} dots over the picture.")
        )
    return [Section("Residuals", [Prose((_RESIDUALS,)), Beside(tuple(charts))])]


def _outline_poses(scored: ScoredPoints, around: Surroundings, target: Target | DotPlaces) -> list[Pose]:
    """Return where the target was in each scored view: by the truth, else laid onto the points."""
    board = target.target if isinstance(target, DotPlaces) else target
    poses = []
    for view, rows in rows_by_name(scored.points.view).items():
        if view in around.poses:
            poses.append(np.asarray(around.poses[view], dtype=np.float64))
        elif len(rows) >= FEWEST:
            numbers = scored.points.index[rows, 1] * board.cols + scored.points.index[rows, 0]
            poses.append(rigid_alignment(scored.places[rows], target.points()[numbers]))
    return poses


def _distance(scored: ScoredPoints, around: Surroundings) -> float | None:
    """Return the median distance of the points from the middle between the cameras, mm."""
    return None if len(scored.places) == 0 else usual_distance(around.cameras.values(), scored.places)


def _longest(scored: ScoredPoints) -> float:
    """Return the longest length between two points of a view, about: the diagonal of their box, mm."""
    sides = [np.ptp(scored.places[rows], axis=0) for rows in rows_by_name(scored.points.view).values()]
    return max((float(np.linalg.norm(side)) for side in sides), default=float("nan"))
