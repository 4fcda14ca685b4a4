"""A pitch that is not as declared: unequal along x and y, or another one than a stage measures."""

from labcal.guide.diagnosis.check_name import CheckName
from labcal.guide.diagnosis.dot_scale import INK_MM, DotScale
from labcal.guide.diagnosis.evidence import Evidence
from labcal.guide.diagnosis.finding import LEAST_HARM, LEVEL, CheckResult, Finding, NotJudged
from labcal.guide.diagnosis.forms.explaining import Explanation
from labcal.guide.diagnosis.forms.shoot_model import ShootModel
from labcal.guide.diagnosis.residual_findings import residual_findings
from labcal.guide.diagnosis.stage_scale import StageScale
from labcal.guide.diagnosis.stage_turns import turned_on_stage

_MEND = (
    "Measure a long row of dots with a ruler and declare the pitch that you find; print at 100%, without "
    "'fit to page'."
)


def check(evidence: Evidence) -> CheckResult:
    """Return the finding."""
    found = residual_findings(evidence, CheckName.WRONG_PITCH, _words)
    scale = StageScale.of(evidence, tuple(turned_on_stage(evidence)))
    if isinstance(found, NotJudged):
        return found if scale is None else _by_stage(evidence, scale)
    if scale is not None:
        return (*found, *_by_stage(evidence, scale))
    if found:
        return found
    by_dots = DotScale.of(evidence)
    if by_dots is not None and by_dots.p_value < LEVEL:
        return _by_dots(evidence, by_dots)
    seen = "" if by_dots is None else " and the dots are as large beside their distances as declared,"
    return NotJudged(
        CheckName.WRONG_PITCH,
        f"The pitches of x and y agree,{seen} but a print that is wrong by the same factor in all cannot be "
        "seen with a target in the hand: the whole rig is scaled with it. A stage's readings, a scale bar or "
        "a measured ruler on the print would decide.",
    )


def _words(model: ShootModel, one: Explanation) -> tuple[str, str]:
    # The column moves the end of the longer side by 1 mm.
    percent = 100.0 * float(one.size[0]) / model.half_side_mm
    return (
        (
            f"The pitch along x is {percent:+.2g}% off, relative to that along y: the print is stretched, or "
            "the declared pitches are not those of this board."
        ),
        _MEND,
    )


def _by_dots(evidence: Evidence, scale: DotScale) -> tuple[Finding, ...]:
    harm = abs(scale.beyond_ink) * scale.spread_mm
    words = (
        f"The dots' diameter over their pitch is off by {scale.diameter_percent:+.2g} +- "
        f"{scale.sigma_percent:.1g}%, more than ink that spreads by {INK_MM:g} mm explains. Either the pitch "
        f"is not the declared one (off by {scale.pitch_percent:+.2g}% if the diameter is right), and all "
        "lengths are wrong by as much; or the diameter is not the declared one, and lengths are right."
    )
    mend = (
        "Measure a long row of dots, and the diameter of one, with a ruler or a caliper, and declare what "
        "you find."
    )
    return (
        Finding(
            CheckName.WRONG_PITCH, evidence.cameras, tuple(evidence.detections.views), words, mend,
            scale.p_value, harm, evidence.harm_percent_of(harm),
        ),
    )  # fmt: skip


def _by_stage(evidence: Evidence, scale: StageScale) -> tuple[Finding, ...]:
    harm = scale.harm_mm
    percent = evidence.harm_percent_of(harm)
    if scale.p_value >= LEVEL or (percent is not None and percent < 100.0 * LEAST_HARM):
        return ()
    words = (
        f"The stage's readings say that the pitch differs from the declared one by {scale.percent:+.2g} +- "
        f"{scale.sigma_percent:.1g}%."
    )
    return (
        Finding(
            CheckName.WRONG_PITCH, evidence.cameras, tuple(evidence.detections.views), words, _MEND,
            scale.p_value, harm, percent,
        ),
    )  # fmt: skip
