"""The design: the target with the smallest dots that are found, and the largest number of them."""

from dataclasses import dataclass

from labcal.errors import InputError
from labcal.guide.target_design.alternatives import alternatives
from labcal.guide.target_design.forms import Need, farthest_mm, formed, need_of
from labcal.guide.target_design.question import TargetQuestion
from labcal.guide.target_design.room import rooms
from labcal.guide.target_design.sight import Sight, least_scale
from labcal.guide.target_design.suitability import Suitability, board_mm, expected_error, shipped_targets
from labcal.guide.target_design.trial import TriedView, tried_views
from labcal.run.progress import Progress, progress_of
from labcal.targets.catalogue import AnyTarget

GROWTHS = (1.0, 1.15, 1.35, 1.6, 2.0)
"""Sizes that are tried one after the other, until all drawn pictures are indexed."""


@dataclass(frozen=True)
class TargetDesign:
    """A designed target, and what speaks for it.

    Parameters
    ----------
    question : TargetQuestion
    target : AnyTarget
    need : Need
        What the detector needs at least.
    least_px : float
        Size of the same part at the far distance and the greatest tilt, by the arithmetic.
    growth : float
        Its parts are so many times as large as needed, since smaller ones were not found in drawn pictures.
    views : tuple of TriedView
        What the detector measured in drawn pictures.
    shipped : tuple of Suitability
        The shipped targets, those that fit first.
    """

    question: TargetQuestion
    target: AnyTarget
    need: Need
    least_px: float
    growth: float
    views: tuple[TriedView, ...]
    shipped: tuple[Suitability, ...]

    @property
    def board_mm(self) -> tuple[float, float]:
        """Width and height of the board, mm."""
        return board_mm(self.target)


def designed(question: TargetQuestion, seed: int = 0, progress: Progress | None = None) -> TargetDesign:
    """Return the target for a question.

    Dots are as small as the detector finds safely at the far distance, tilted the most, since many small dots
    hold more than few large ones: the edges of all dots together are longer. The board is as large as paper,
    picture and working volume allow. The design is tried in drawn pictures, and made larger where one is not
    indexed.

    Parameters
    ----------
    question : TargetQuestion
    seed : int
        Of the drawn pictures.
    progress : Progress, optional

    Raises
    ------
    InputError
        No target on this paper is found at that distance and tilt; the message says what would do.
    """
    receiver = progress_of(progress)
    sights = [Sight.of(camera) for camera in question.different_cameras.values()]
    need = need_of(question.kind, question.photometry.blur_px)
    tried: tuple[TriedView, ...] = ()
    for growth in GROWTHS:
        target = _best(question, sights, growth)
        if target is None:
            break
        tried = tried_views(target, question, seed, receiver)
        if all(view.passed for view in tried):
            scale = least_scale(sights, farthest_mm(question, max(board_mm(target))), question.tilt_max_deg)
            least_px = need.feature_mm(target) * scale
            return TargetDesign(
                question, target, need, least_px, growth, tried, shipped_targets(question, sights, target)
            )
    raise InputError(_refusal(question, sights, tried))


def _best(question: TargetQuestion, sights: list[Sight], growth: float) -> AnyTarget | None:
    """Return the best target of both orientations of the paper; None where neither has room for one."""
    found = [formed(question, sights, room, growth) for room in rooms(question, sights)]
    there = [target for target in found if target is not None]
    return min(there, key=lambda target: expected_error(target, question, sights), default=None)


_LITTLE = 0.25
"""Of the paper's shorter side: where pictures show less than that, the near distance is what is wrong."""


def _refusal(question: TargetQuestion, sights: list[Sight], tried: tuple[TriedView, ...]) -> str:
    """Return why there is no target, and what would do."""
    easier = alternatives(question, lambda changed: _best(changed, sights, 1.0) is not None)
    mend = f"Ask for {' or '.join(easier)}." if easier else "Take cameras with more pixels or a longer lens."
    failed = [view for view in tried if not view.passed]
    if failed:
        view = failed[0]
        why = view.refusal or f"{view.found} of {view.whole} dots measured"
        return (
            f"No target of the kind '{question.kind}' on {question.paper.sides} is found in all drawn "
            f"pictures: "
            f"at {view.distance_mm:g} mm, tilted by {view.tilt_deg:g} degrees ({why}). {mend}"
        )
    width, height = (
        min(sides) for sides in zip(*(s.width_mm(question.near_mm) for s in sights), strict=True)
    )
    if min(width, height) < _LITTLE * min(question.paper.width_mm, question.paper.height_mm):
        return (
            f"No target of the kind '{question.kind}' is found: at {question.near_mm:g} mm the pictures show "
            f"{width:.3g} mm x {height:.3g} mm, and the whole board must be in them. Distances are in mm "
            "(1 m is 1000): give greater ones, or a lens with a wider field of view."
        )
    scale = least_scale(sights, question.far_mm, question.tilt_max_deg)
    part = need_of(question.kind, question.photometry.blur_px)
    return (
        f"No target of the kind '{question.kind}' fits on {question.paper.sides}: at "
        f"{question.far_mm:g} mm and "
        f"a tilt of {question.tilt_max_deg:g} degrees a {part.part} of {part.least_px:.3g} px is "
        f"{part.least_px / scale:.1f} mm, and there is too little room for enough of them. {mend}"
    )
