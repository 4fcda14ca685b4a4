"""Result of ``labcal rehearse``: the JSON document, and the same for people."""

from dataclasses import dataclass

import numpy as np
from rich.console import Group, RenderableType
from rich.table import Table
from rich.text import Text

from labcal.guide.rehearsal.confirmation import Confirmation
from labcal.guide.rehearsal.forecast import rms
from labcal.guide.rehearsal.limits import Limit
from labcal.guide.rehearsal.rehearsal import Rehearsal
from labcal.paths import AnyPath


@dataclass(frozen=True)
class LimitResult:
    """A limit in the JSON document."""

    name: str
    change: str
    """The change that halves it."""
    before_mm: float
    after_mm: float
    """RMS 3-D error after the change; null where the changed rig cannot be calibrated."""
    gain: float
    """Share by which the error falls."""
    why_not: str | None


@dataclass(frozen=True)
class BoardResult:
    """A size of the target in the JSON document."""

    scale: float
    """Of the planned target."""
    size_mm: tuple[float, float]
    dot_px: float
    """Median minor semi-axis of its dots."""
    coverage: float
    """Share of the picture that the dots span in the median view."""
    found: float
    """Share of the dots that the detector measures in drawn pictures."""
    rms_mm: float
    why_not: str | None


@dataclass(frozen=True)
class ConfirmationResult:
    """The rendered rig in the JSON document."""

    views: int
    points: int
    dot_rms_px: float
    """RMS error of a coordinate of measured dots."""
    dot_expected_px: float
    """The same as foretold."""
    rms_mm: float
    """RMS 3-D error of the points of further views, in the frame of the first camera."""
    expected_mm: float
    range_mm: tuple[float, float]
    """Of the error after a single calibration, in 95 of 100."""
    holds: bool


@dataclass(frozen=True)
class RehearseResult:
    """The JSON document of ``labcal rehearse``."""

    folder: str
    plan: str
    rms_mm: float
    """Expected RMS 3-D error over the working volume, in the frame of the first camera."""
    noise_mm: float
    """Its share by the pixels of the points themselves."""
    calibration_mm: float
    """Its share by the calibration."""
    depth_mm: float
    sideways_mm: float
    """RMS standard deviations in depth, and across (of one axis)."""
    range_mm: tuple[float, float]
    """Of the RMS error after a single calibration, in 95 of 100."""
    seen: float
    """Share of the working volume that all cameras see."""
    dot_px: float
    """Typical minor semi-axis of the target's dots."""
    dot_sigma_px: float
    """Standard deviation of a coordinate of a dot of that size."""
    dots_found: float
    """Share of the dots that the detector measures in drawn pictures."""
    views: int
    enough_views: int | None
    """Least number from which on twice as many bring less than a tenth; null if none does."""
    view_counts: list[tuple[int, float]]
    """Numbers of views, each with the RMS 3-D error after it."""
    limited_by: str
    limits: list[LimitResult]
    free_dots_mm: float
    """RMS 3-D error where the calibration estimates the dots' places, too; null where that does not apply."""
    boards: list[BoardResult]
    best_board: float | None
    """Scale of the board with the least error of those that fit; null if none does."""
    confirmation: ConfirmationResult | None
    warnings: list[str]


def rehearse_result(folder: AnyPath, found: Rehearsal) -> RehearseResult:
    """Return the JSON document; `folder` is where everything is."""
    made, best = found.forecast, found.best_board
    whole = max(1, sum(one.whole for one in found.pictures))
    return RehearseResult(
        folder=str(folder),
        plan=found.plan.name,
        rms_mm=made.rms_mm,
        noise_mm=rms(np.sqrt(np.trace(made.noise, axis1=1, axis2=2))),
        calibration_mm=made.calibration_mm,
        depth_mm=rms(made.depth_mm),
        sideways_mm=rms(made.sideways_mm),
        range_mm=(made.lowest_mm, made.highest_mm),
        seen=float(made.seen.mean()),
        dot_px=found.noise.size_px,
        dot_sigma_px=float(np.sqrt(found.noise.variance)),
        dots_found=sum(one.found for one in found.pictures) / whole,
        views=len(found.views),
        enough_views=found.enough_views,
        view_counts=[(one.views, one.rms_mm) for one in found.counts],
        limited_by=found.limited_by,
        limits=[_limit(one) for one in found.limits],
        free_dots_mm=found.freed_mm,
        boards=[
            BoardResult(
                one.scale, (one.width_mm, one.height_mm), one.dot_px, one.coverage, one.found, one.rms_mm,
                one.why_not or None,
            )
            for one in found.boards
        ],
        best_board=None if best is None else best.scale,
        confirmation=None if found.confirmation is None else _confirmation(found.confirmation),
        warnings=list(found.warnings),
    )  # fmt: skip


def rehearse_table(result: RehearseResult) -> Group:
    """Return the document for people."""
    low, high = result.range_mm
    head = (
        f"{result.plan}: expect {result.rms_mm:.3g} mm RMS in 3-D over the working volume "
        f"({low:.2g} to {high:.2g} mm after a single calibration, in 95 of 100): {result.noise_mm:.2g} mm by "
        f"the points' pixels, {result.calibration_mm:.2g} mm by the calibration; {result.depth_mm:.2g} mm in "
        f"depth, {result.sideways_mm:.2g} mm sideways."
    )
    table = Table("what helps", "RMS error after it (mm)", "gain")
    for limit in result.limits:
        gain = "-" if limit.why_not else f"{100.0 * limit.gain:.0f}%"
        table.add_row(limit.change, "-" if limit.why_not else f"{limit.after_mm:.3g}", gain)
    parts: list[RenderableType] = [Text(head), table]
    parts += [Text(words) for words in (*freed_words(result), views_words(result), board_words(result))]
    if result.confirmation is not None:
        parts.append(Text(confirmation_words(result.confirmation)))
    parts.append(Text(f"{result.folder}: index.html, rehearsal.json, map.csv, poses.csv, rig.json."))
    return Group(*parts)


def freed_words(result: RehearseResult) -> list[str]:
    """Return what estimating the dots' places would bring, in words; nothing where it brings nothing."""
    if not result.free_dots_mm < result.rms_mm:  # of NaN, too
        return []
    return [
        f"Print: estimating the places of the dots, too, would give {result.free_dots_mm:.3g} mm (free_dots)."
    ]


def views_words(result: RehearseResult) -> str:
    """Return how many views are enough, in words."""
    if result.enough_views is None:
        return f"Views: {result.views} are planned, and more help up to the largest number tried."
    return (
        f"Views: {result.views} are planned; from {result.enough_views} on, twice as many bring less than a "
        "tenth."
    )


def board_words(result: RehearseResult) -> str:
    """Return which board fits, in words."""
    best = next((one for one in result.boards if one.scale == result.best_board), None)
    if best is None:
        return "Board: no size that was tried fits; see rehearsal.json for why."
    width, height = best.size_mm
    size = f"{width:.0f} x {height:.0f} mm, dots of {best.dot_px:.1f} px radius"
    if best.scale == 1.0:
        return f"Board: the planned size fits best ({size})."
    return f"Board: printed {best.scale:g} times as large ({size}) it would give {best.rms_mm:.3g} mm."


def confirmation_words(one: ConfirmationResult) -> str:
    """Return the confirmation in words."""
    low, high = one.range_mm
    verdict = "within" if one.holds else "OUTSIDE"
    return (
        f"Rendered: {one.points} points of further views, RMS error {one.rms_mm:.3g} mm, foretold "
        f"{one.expected_mm:.3g} mm, {verdict} the range of a single calibration ({low:.2g} to {high:.2g} "
        f"mm); dots {one.dot_rms_px:.2g} px, foretold {one.dot_expected_px:.2g} px."
    )


def _limit(one: Limit) -> LimitResult:
    return LimitResult(one.name.value, one.change, one.before_mm, one.after_mm, one.gain, one.why_not or None)


def _confirmation(one: Confirmation) -> ConfirmationResult:
    return ConfirmationResult(
        views=one.views,
        points=one.points,
        dot_rms_px=one.dot_rms_px,
        dot_expected_px=one.dot_expected_px,
        rms_mm=one.rms_mm,
        expected_mm=one.expected_mm,
        range_mm=(one.lowest_mm, one.highest_mm),
        holds=one.holds,
    )
