"""Suitability of a target for a question: parts that are too small or too large, and the expected error."""

import math
from dataclasses import dataclass

from labcal.guide.target_design.forms import farthest_mm, need_of
from labcal.guide.target_design.question import TargetQuestion
from labcal.guide.target_design.room import fits_paper
from labcal.guide.target_design.sight import Sight, least_scale
from labcal.targets.catalogue import AnyTarget, load_target, target_names
from labcal.targets.grid import DotGrid
from labcal.targets.paper import smallest_paper
from labcal.targets.registry import kind_of


@dataclass(frozen=True)
class Suitability:
    """A target beside a question.

    Parameters
    ----------
    target : str
    reasons : tuple of str
        Why it does not fit; empty where it does.
    relative_error : float
        Expected error of a calibration over that of the designed target; NaN where the target does not fit.
    paper : str or None
        The smallest paper of its sheet.
    """

    target: str
    reasons: tuple[str, ...]
    relative_error: float
    paper: str | None

    @property
    def fits(self) -> bool:
        """True if there is nothing against it."""
        return not self.reasons


def shipped_targets(
    question: TargetQuestion, sights: list[Sight], designed: AnyTarget
) -> tuple[Suitability, ...]:
    """Return how the shipped targets fit, those that do first, the best of them first.

    Parameters
    ----------
    question : TargetQuestion
    sights : list of Sight
        Of its cameras.
    designed : AnyTarget
        The target to compare with.
    """
    own = expected_error(designed, question, sights)
    found = []
    for name in target_names():
        target = load_target(name)
        reasons = tuple(reasons_against(target, question, sights))
        error = math.nan if reasons else expected_error(target, question, sights) / own
        paper = smallest_paper(target)
        found.append(Suitability(name, reasons, error, None if paper is None else paper.name))
    return tuple(sorted(found, key=lambda one: (not one.fits, one.relative_error if one.fits else 0.0)))


def reasons_against(target: AnyTarget, question: TargetQuestion, sights: list[Sight]) -> list[str]:
    """Return why a target does not fit a question."""
    reasons = []
    if kind_of(target).name != question.kind:
        reasons.append(f"of the kind {kind_of(target).name}")
    if isinstance(target, DotGrid) and target.rings is None:
        reasons.append("without rings: every picture must show the whole of it")
    if not fits_paper(target, question):
        paper = smallest_paper(target)
        reasons.append("too large for any usual paper" if paper is None else f"needs {paper.name}")
    need = need_of(kind_of(target).name, question.photometry.blur_px)
    width, height = board_mm(target)
    scale = least_scale(sights, farthest_mm(question, max(width, height)), question.tilt_max_deg)
    size = need.feature_mm(target) * scale
    if size < need.least_px - 0.05:
        reasons.append(
            f"too small: {need.part} of {size:.1f} px at the far distance, {need.least_px:.3g} needed"
        )
    span = rings_mm(target)
    near = min(min(sight.width_mm(question.near_mm)) for sight in sights)
    if span > near:
        reasons.append(
            f"too large: its rings are {span:.0f} mm apart, and {near:.0f} mm are seen at the near distance"
        )
    return reasons


def board_mm(target: AnyTarget) -> tuple[float, float]:
    """Return width and height of the board, mm."""
    x_min, y_min, x_max, y_max = target.extent_mm
    return x_max - x_min, y_max - y_min


def rings_mm(target: AnyTarget) -> float:
    """Return the distance between the outer ends of the rings of a grid; 0 where any part is enough."""
    if not isinstance(target, DotGrid) or target.rings is None:
        return 0.0
    x, y = target.rings.x_steps * target.pitch_x_mm, target.rings.y_steps * target.pitch_y_mm
    return math.hypot(x, y) + target.largest_diameter_mm


def expected_error(target: AnyTarget, question: TargetQuestion, sights: list[Sight]) -> float:
    """Return the expected error of a calibration, in a unit of its own: to compare targets with.

    The variance of a dot goes with one over its semi-axis (the Cramer-Rao bound of a disc under white noise),
    that of a mean with one over the number of dots seen, and the lever of all with the length that they span,
    the root of the area.

    Parameters
    ----------
    target : AnyTarget
    question : TargetQuestion
    sights : list of Sight
    """
    total = 0.0
    width, height = board_mm(target)
    for sight in sights:
        across, up = sight.width_mm(question.middle_mm)
        share = min(1.0, max(width, height) / max(across, up)) * min(
            1.0, min(width, height) / min(across, up)
        )
        seen = min(1.0, across * up * share / (width * height))
        size = _edge_mm(target) * sight.px_per_mm(question.middle_mm, 0.0)
        total += target.count * seen * size * share
    return 1.0 / math.sqrt(total)


def _edge_mm(target: AnyTarget) -> float:
    """Return the length by which edges count: a dot's radius, a quarter of a square's side."""
    radius = 0.5 * float(target.outer_diameters_mm().min())
    return radius if radius > 0.0 else 0.25 * float(getattr(target, "square_mm", 1.0))
