"""Results of the pictures of the suite, and checks of them."""

from dataclasses import dataclass

import numpy as np

from labcal.bench.detect.design import PictureDesign
from labcal.bench.detect.opencv_grid import MODES
from labcal.bench.detect.verdict import Verdict
from labcal.report.bench import Check, Figure, at_most
from labcal.run.tables import table_text

TILT_DEG, HIDDEN = 60.0, 0.3
"""Up to these a picture must be indexed."""
NOT_INDEXED, MISSED = 0.01, 0.02


@dataclass(frozen=True)
class Outcome:
    """The result of one picture."""

    design: PictureDesign
    dots: int
    hidden: float
    rings_in_sight: bool
    blur_px: float
    verdict: Verdict
    opencv: tuple[bool, ...]
    """True if OpenCV finds the grid, by :data:`MODES`."""

    @property
    def is_required(self) -> bool:
        """True if the picture must be indexed."""
        return self.design.tilt_deg <= TILT_DEG and self.hidden <= HIDDEN and self.rings_in_sight

    @property
    def failed(self) -> bool:
        """True if a person should look at the picture."""
        verdict = self.verdict
        lost = not verdict.indexed or verdict.found < (1.0 - MISSED) * verdict.measurable
        return verdict.wrong_ids > 0 or verdict.false_dots > 0 or (self.is_required and lost)


def suite_checks(outcomes: list[Outcome]) -> list[Check]:
    """Return the numbers of pictures not indexed and of dots missed, wrong and false."""
    required = [outcome for outcome in outcomes if outcome.is_required]
    verdicts = [outcome.verdict for outcome in outcomes]
    lost = np.mean([not outcome.verdict.indexed for outcome in required])
    measurable = sum(outcome.verdict.measurable for outcome in required)
    found = sum(outcome.verdict.found for outcome in required)
    which = f"{len(required)} of {len(outcomes)} pictures up to {TILT_DEG:g} degrees, {HIDDEN:.0%} hidden"
    return [
        at_most(f"suite, {which}: share not indexed", float(lost), NOT_INDEXED),
        at_most(
            "suite, the same pictures: share of measurable dots missed", 1.0 - found / measurable, MISSED
        ),
        at_most("suite, all pictures: wrong ids", sum(verdict.wrong_ids for verdict in verdicts), 0),
        at_most("suite, all pictures: false dots", sum(verdict.false_dots for verdict in verdicts), 0),
    ]


def suite_figures(outcomes: list[Outcome]) -> list[Figure]:
    """Return the same numbers for OpenCV, and for pictures that need not be indexed."""
    required = [outcome for outcome in outcomes if outcome.is_required]
    whole = [outcome for outcome in required if outcome.hidden == 0.0]
    figures = []
    for number, mode in enumerate(MODES):
        for what, some in (("the same pictures", required), ("those of them with nothing hidden", whole)):
            share = float(np.mean([not outcome.opencv[number] for outcome in some])) if some else np.nan
            figures.append(Figure(name=f"suite, {what}: share not found by OpenCV ({mode})", value=share))
    others = [outcome for outcome in outcomes if not outcome.is_required]
    for what, rest in (
        ("a ring out of sight", [outcome for outcome in others if not outcome.rings_in_sight]),
        ("rings in sight, steeper or more hidden", [outcome for outcome in others if outcome.rings_in_sight]),
    ):
        share = float(np.mean([not outcome.verdict.indexed for outcome in rest])) if rest else np.nan
        figures.append(Figure(name=f"suite, {len(rest)} pictures, {what}: share not indexed", value=share))
    measured = max(sum(outcome.verdict.measured for outcome in outcomes), 1)
    misled = sum(outcome.verdict.misled for outcome in outcomes) / measured
    figures.append(Figure(name="suite, all pictures: share of measured dots misled", value=misled))
    astray = sum(outcome.verdict.astray for outcome in outcomes)
    figures.append(Figure(name="suite, all pictures: flagged dots drawn half a pitch off", value=astray))
    return figures


_HEADER = (
    "name", "required", "failed", "lens", "width", "height", "tilt_deg", "radius_px", "pitch_over_radius",
    "polarity", "gradient", "noise", "blur_px", "jpeg_quality", "bayer", "linear", "hidden", "rings_in_sight",
    "dots", "measurable", "found", "refusal", "wrong_ids", "astray", "false_dots", "worst_px", "opencv",
)  # fmt: skip


def outcome_table(outcomes: list[Outcome]) -> str:
    """Return a table with one line per picture."""
    lines: list[list[object]] = []
    for outcome in outcomes:
        design, verdict = outcome.design, outcome.verdict
        lines.append(
            [
                design.name, int(outcome.is_required), int(outcome.failed), design.lens, *design.size,
                round(design.tilt_deg, 1), round(design.radius_px, 1), round(design.pitch_over_radius, 2),
                design.polarity, round(design.gradient, 2), round(design.noise, 4), round(outcome.blur_px, 2),
                design.jpeg_quality or "", int(design.bayer), int(design.linear), round(outcome.hidden, 3),
                int(outcome.rings_in_sight), outcome.dots, verdict.measurable, verdict.found,
                verdict.refusal or "", verdict.wrong_ids, verdict.astray, verdict.false_dots,
                round(verdict.worst_px, 3),
                " ".join(str(int(found)) for found in outcome.opencv),
            ]
        )  # fmt: skip
    return table_text(_HEADER, lines)
