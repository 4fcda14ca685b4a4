"""The page of ``labcal check``: the verdict, what changed, what could have been found, the log over time."""

from collections.abc import Sequence

from labcal.evaluate.verdict.amounts import millimetres
from labcal.evaluate.verdict.verdict import Belief, Verdict
from labcal.guide.check_log import CheckRecord
from labcal.guide.rig_check import CheckVerdict, RigCheck
from labcal.report.check_history import check_history
from labcal.report.check_result import cost_words, unnamed_words
from labcal.report.page.chart import Chart
from labcal.report.page.document import Page, Section
from labcal.report.page.prose import Prose
from labcal.report.page.statement import Statement
from labcal.report.page.table import MISSING, Column, PageTable, Side
from labcal.report.page_maker import PageMaker
from labcal.wording import counted

_CHANGES = (
    "Every kind of change was fitted to the new pictures, with the covariance of the calibration as a prior. "
    "The p-value tells whether noise and the calibration's errors explain as much; the probability is that "
    "of the change, given that there is one."
)
_AMBIGUOUS = (
    "Between two cameras a shift of the one and an opposite shift of the other look the same in all pictures "
    "of a target in the hand, and so does a turn about the line through both."
)
_BY_MARKS = (
    "The marks stay where they are, and the rig measured their places before: so each camera has a place of "
    "its own, and a shift is that of one camera. All cameras together may have moved as one body, too, which "
    "leaves the calibration as it is."
)
_SMALLEST = "Each of these would be found nine times in ten, with the errors of the calibration allowed for."
_OVER_TIME = (
    "RMS error of points by the change of each check, beside the sigma of a point by noise and calibration."
)


_MORE = "take more pictures, with different tilts, all over the volume"


def check_page(found: RigCheck, records: Sequence[CheckRecord], maker: PageMaker) -> Page:
    """Return the page of a check.

    Parameters
    ----------
    found : RigCheck
    records : sequence of CheckRecord
        The log, this check last; empty where none is kept.
    maker : PageMaker
    """
    names = list(found.rig.cameras)
    marks = found.tested.made.marks
    notes = (unnamed_words(found), _BY_MARKS if marks else _AMBIGUOUS)
    sections = [
        Section("What changed", [Prose((_CHANGES, *(words for words in notes if words))), _changes(found)]),
        Section("What could have been found", [Prose((_SMALLEST,)), _smallest(found)]),
    ]
    if records:
        sections.append(Section("Over time", _history(records)))
    return Page(
        title=f"Check of {', '.join(names)}",
        heading=f"Check of the calibration of {', '.join(names)}",
        lead=f"{counted(len(found.views), 'new view')}, {counted(found.dots, 'pixel' if marks else 'dot')}"
        f"{f', {found.outliers} left out' if found.outliers else ''}.",
        sections=sections,
        provenance=maker.provenance,
        opening=[Statement(_verdict(found), maker.phrase), *maker.notes(found.warnings)],
    )


def _verdict(found: RigCheck) -> Verdict:
    """Return the verdict as pages state them."""
    budget = float("nan") if found.budget_mm is None else found.budget_mm
    missed = float("nan") if found.undetected_mm is None else found.undetected_mm
    leaves_out = (
        "a print that is too large as a whole: to two cameras it looks like a shift of one of them",
    )
    if found.verdict is CheckVerdict.CHANGED:
        extra = millimetres(float("nan") if found.cost is None else found.cost.rms_mm)
        return Verdict(
            expectation=f"errors of about {extra} (RMS, in 3-D) by the change, beside {millimetres(budget)} "
            "by noise and calibration",
            belief=Belief.NO,
            reasons=(found.changes[0].words,),
            limit="the change of the rig",
            advice="correct the rig, or calibrate anew",
            leaves_out=leaves_out,
        )
    valid = found.verdict is CheckVerdict.VALID
    return Verdict(
        expectation=f"errors as calibrated, about {millimetres(budget)} (1 sigma, in 3-D)",
        belief=Belief.YES if valid else Belief.PARTLY,
        reasons=(
            f"no change is found (p = {found.p_value:.2g})",
            f"a change that costs {millimetres(missed)} (RMS) would be missed once in ten checks",
        ),
        limit="the calibration" if valid else "what these pictures can tell",
        advice="go on measuring"
        if valid
        else "take more pictures, with different tilts, all over the volume",
        leaves_out=leaves_out,
    )


def _changes(found: RigCheck) -> PageTable:
    columns = [
        Column("change", Side.WIDE),
        Column("probability"),
        Column("p-value", meaning="not corrected for the number of changes that were tried"),
    ]
    rows = [
        [f"{one.words[:1].upper()}{one.words[1:]}", f"{one.probability:.2f}", f"{one.p_value:.2g}"]
        for one in found.changes
    ]
    caption = f"p-value of all together: {found.p_value:.2g}. {cost_words(found)}".strip()
    return PageTable("changes", caption, columns, rows)


def _smallest(found: RigCheck) -> PageTable:
    columns = [Column("camera", Side.LEFT), Column("change", Side.LEFT), Column("size")]
    units = {"degrees": "degrees", "mm": "mm", "percent": "% of the focal length"}
    rows = [
        [" or ".join(one.cameras), one.kind.value, f"{one.size:.2g} {units[one.unit]}"]
        for one in found.smallest
    ]
    caption = "The worst of these that is missed costs "
    caption += MISSING if found.undetected_mm is None else f"{found.undetected_mm:.2g} mm RMS."
    return PageTable("smallest", caption, columns, rows)


def _history(records: Sequence[CheckRecord]) -> list[Chart | PageTable]:
    """Return the log as a figure and as a table, the last check first."""
    columns = [
        Column("date", Side.LEFT), Column("verdict", Side.LEFT), Column("p-value"),
        Column("camera", Side.LEFT),
        Column("cost (mm)"), Column("budget (mm)"), Column("temperature (°C)"), Column("note", Side.WIDE),
    ]  # fmt: skip
    rows = [
        [
            one.date, one.verdict.value, f"{one.p_value:.2g}", one.camera or MISSING,
            _number(one.cost_rms_mm),
            _number(one.budget_mm), _number(one.temperature_c), one.note or MISSING,
        ]
        for one in reversed(records)
    ]  # fmt: skip
    return [
        Chart("history", check_history(records), _OVER_TIME),
        PageTable("log", f"{counted(len(records), 'check')}, the last first.", columns, rows),
    ]


def _number(value: float | None) -> str:
    return MISSING if value is None else f"{value:.3g}"
