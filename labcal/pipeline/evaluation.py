"""Errors of points in millimetres."""

import os
from collections.abc import Collection
from dataclasses import replace
from typing import TYPE_CHECKING

from labcal.arguments import texts
from labcal.cameras.rig import Rig
from labcal.correspond.boards_points import (
    points_of_boards,
    points_on_target,
    with_known_lengths,
    with_views_of_boards,
)
from labcal.correspond.boards_table import in_one_frame
from labcal.correspond.detections import Detections
from labcal.correspond.points import Points
from labcal.errors import InputError, UnknownNameError
from labcal.estimators.model import Model
from labcal.paths import AnyPath, as_path
from labcal.pipeline.given import dots_of, shown_by
from labcal.pipeline.pages import claimed_page, page_maker
from labcal.pipeline.print_places import dots_beside
from labcal.shoot.dataset import Shoot
from labcal.targets.board_set import BoardSet
from labcal.targets.catalogue import AnyTarget, AnyTargets
from labcal.targets.kept_target import kept_target
from labcal.targets.places import DotPlaces, is_places, read_places

if TYPE_CHECKING:
    from labcal.evaluate.against_truth import Alignment, TruthErrors
    from labcal.evaluate.aligned_budget import PointOrigin
    from labcal.evaluate.own_lengths import LengthErrors
    from labcal.report.page.output import PageOutput


def _kept_by(rig: Rig | Model | Collection[str] | AnyPath | None) -> AnyTarget | DotPlaces:
    """Return the target that a rig was calibrated with, or the places of its dots."""
    origin = _origin_of(rig)
    target = None if origin is None else kept_target(origin.rig)
    if target is None:
        raise InputError(
            "It is not known what the points are of. Give the shoot, the target or the places of its dots; "
            "or a rig that keeps the target of its calibration (those of older versions do not)."
        )
    return dots_beside(rig, target) if isinstance(rig, str | os.PathLike) else target


def _scored_by(source: Shoot | AnyTargets | DotPlaces) -> Shoot | AnyTarget | DotPlaces:
    """Return what points are of: a shoot, a target or the places of its dots, by their path, too."""
    if isinstance(source, DotPlaces):
        return source
    if isinstance(source, str | os.PathLike) and os.fspath(source) and is_places(source):
        return read_places(source)
    return shown_by(source)


def _origin_of(rig: Rig | Model | Collection[str] | AnyPath | None) -> "PointOrigin | None":
    """Return the rig in whose world points are, read where a path was given; None of anything else."""
    from labcal.cameras.rig_file import read_rig
    from labcal.estimators.model_file import ModelKind, model_kind, placing_rig
    from labcal.evaluate.aligned_budget import PointOrigin

    if isinstance(rig, str | os.PathLike):
        path = as_path(rig)
        triangulated = model_kind(path) is ModelKind.RIG
        found = read_rig(path) if triangulated else placing_rig(path)
    else:
        triangulated = isinstance(rig, Rig)
        found = rig if isinstance(rig, Rig) else rig.placed_by if isinstance(rig, Model) else None
    return None if found is None else PointOrigin(found, triangulated)


def _calibration_views_of(rig: Rig | Model | Collection[str] | AnyPath | None) -> Collection[str] | None:
    """Return the views that points come from; None where they are not known."""
    from labcal.reconstruct.reconstruction import calibration_views

    if rig is None:
        return None
    if isinstance(rig, Rig | Model):
        return rig.calibrated_on or None
    if isinstance(rig, str | os.PathLike) or not isinstance(rig, Collection):
        return calibration_views(as_path(rig)) or None
    return texts(rig, "rig")


def evaluate(
    points: Points | AnyPath,
    source: Shoot | AnyTargets | DotPlaces | None = None,
    detections: Detections | AnyPath | None = None,
    alignment: "Alignment | None" = None,
    rig: Rig | Model | Collection[str] | AnyPath | None = None,
    *,
    page: "PageOutput | AnyPath | None" = None,
) -> "TruthErrors | LengthErrors":
    """Return the errors of points in mm, against the truth where a shoot has one, else against lengths.

    Parameters
    ----------
    points : Points or path
    source : Shoot, AnyTarget, DotPlaces, path, str or sequence of targets, optional
        The shoot that the points are of, or its folder; or, to compare with the target's own lengths, the
        target or its name, or the places of its dots or their file (``RIG-dots.json``). If left out, the
        target that the rig was calibrated with, with the file beside that of the rig. Several targets are
        boards side by side: lengths between boards count only where their places are stated.
    detections : Detections or path, optional
        What the points came from; gives the limit of triangulation.
    alignment : {"none", "rigid"}, optional
        How the points are brought onto the truth; rigid for a target in the hand, else none.
    rig : Rig, Model, path or collection of str, optional
        What the points were reconstructed with, or the views that it was calibrated from: these are not
        scored, or are said to be. With a rig and detections, the coverage after a rigid alignment is that of
        what the alignment leaves of the calibration's errors.
    page : path, optional
        A page to write, ``.html``: a verdict in one sentence, figures and a 3-D view.

    Returns
    -------
    TruthErrors or LengthErrors
        Errors in mm: of points where the shoot has a truth, else of lengths.

    Raises
    ------
    InputError
        The points are not of that target or shoot, or something is given that needs a truth.
    OutputError
        The page may not be written.

    Examples
    --------
    >>> from labcal import examples, pipeline
    >>> pipeline.evaluate(examples.points(), examples.TARGET)
    LengthErrors(n=30624, rms=0.0431 mm, max=0.332 mm, scale=-2.8 ppm)
    """
    from labcal.correspond.points_csv import read_points
    from labcal.evaluate.against_truth import ALIGNMENTS
    from labcal.evaluate.own_lengths import LengthErrors

    output = claimed_page(page, [points, source, detections, rig])
    if alignment is not None and alignment not in ALIGNMENTS:
        raise UnknownNameError("alignment", alignment, ALIGNMENTS)
    shown = _kept_by(rig) if source is None else _scored_by(source)
    _refuse_without_truth(shown, detections, alignment)
    found = points if isinstance(points, Points) else read_points(as_path(points))
    target = shown.target if isinstance(shown, Shoot) else shown
    numbered = found if isinstance(target, DotPlaces) else points_on_target(found, target)
    found, errors = _errors(numbered, shown, detections, alignment, rig)
    if output is not None:
        from labcal.pipeline.surroundings import surroundings
        from labcal.report.evaluation_page import evaluation_page

        given = {"points": points, "source": source, "detections": detections, "alignment": alignment}
        maker = page_maker(output, "evaluate", {**given, "rig": rig, "page": output.path})
        around = surroundings(errors, shown, rig, detections)
        output.write(evaluation_page(errors, found, target, around, maker))
    if isinstance(target, BoardSet) and not isinstance(errors, LengthErrors):
        return replace(errors, points=points_of_boards(errors.points, target))
    return errors


def _refuse_without_truth(
    shown: Shoot | AnyTarget | DotPlaces,
    detections: Detections | AnyPath | None,
    alignment: "Alignment | None",
) -> None:
    """Raise where something is given that needs a truth, and there is none."""
    from labcal.shoot.truth import has_truth

    if isinstance(shown, Shoot) and has_truth(shown.folder):
        return
    for name, given in (("detections", detections), ("alignment", alignment)):
        if given is not None:
            raise InputError(
                f"`{name}` goes with the truth of a rendered shoot, which is not given here. Leave it out."
            )


def _errors(
    found: Points,
    shown: Shoot | AnyTarget | DotPlaces,
    detections: Detections | AnyPath | None,
    alignment: "Alignment | None",
    rig: Rig | Model | Collection[str] | AnyPath | None,
) -> "tuple[Points, TruthErrors | LengthErrors]":
    """Return the errors of points, as :func:`evaluate`, and these with the views by which they are scored.

    Points have the numbers of the target. Where the places of boards are not known, each is a view by itself.
    """
    from labcal.evaluate.against_truth import errors_against_truth
    from labcal.evaluate.own_lengths import errors_of_lengths
    from labcal.evaluate.scored_views import ScoredViews
    from labcal.shoot.truth import has_truth

    origin = _origin_of(rig)
    learned = _calibration_views_of(origin.rig if origin is not None and origin.triangulated else rig)
    if isinstance(shown, DotPlaces):
        return found, errors_of_lengths(found, shown, learned)
    target = shown.target if isinstance(shown, Shoot) else shown
    if isinstance(shown, Shoot) and has_truth(shown.folder):
        dots = None if detections is None else in_one_frame(dots_of(detections, None), target)
        return found, errors_against_truth(found, shown, dots, alignment, learned, origin)
    if isinstance(shown, Shoot) and learned is None:
        found = found.where(ScoredViews.by_role(found.view, shown).holds(found.view))
    found = with_known_lengths(found, target)
    return found, errors_of_lengths(found, target, with_views_of_boards(learned, target))
