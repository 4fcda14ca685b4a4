"""Result of ``labcal certify``: the JSON documents, and the same for people."""

from dataclasses import dataclass

import numpy as np
from rich.console import Group
from rich.table import Table

from labcal.evaluate.acceptance.certificate import Certificate, length_columns
from labcal.evaluate.acceptance.decision import Outcome, Rule, Uncertainty
from labcal.evaluate.acceptance.length_plan import LengthPlan, plan_rows
from labcal.report.values import Measured
from labcal.wording import counted


@dataclass(frozen=True)
class CertifiedLength:
    """A length in the JSON document, mm."""

    line: str
    length: str
    nominal_mm: float
    measured_mm: Measured
    """Null if it was not measured."""
    error_mm: Measured
    """Measured minus calibrated."""
    noise_sigma_mm: Measured
    """Standard deviation by the noise of the pixels."""
    reference_sigma_mm: float
    calibration_sigma_mm: Measured
    """Standard deviation by the errors of the calibration, which the test is of; null if not known."""
    limit_mm: Measured
    guard_within_mm: Measured
    """Guard band within the limit."""
    guard_beyond_mm: Measured
    outcome: str


@dataclass(frozen=True)
class CertifyResult:
    """The JSON document of ``labcal certify``."""

    outcome: str
    """``conforming``, ``not-conforming``, ``undecided``, ``incomplete`` or ``no-limit``."""
    n: int
    """Number of lengths that were measured."""
    lines: int
    """Number of measuring lines that they are on."""
    largest_error_mm: float
    """With its sign."""
    rms_error_mm: float
    limit_mm: float | None
    limit_ppm: float
    rule: str
    confidence: float
    uncertainty: str
    """Sources that the uncertainty of the test holds."""
    date: str
    operator: str | None
    temperature_c: float | None
    volume_mm: list[float] | None
    lengths: list[CertifiedLength]
    missing: list[str]
    """Reasons why lengths were not measured."""
    warnings: list[str]


def certify_result(found: Certificate) -> CertifyResult:
    """Return the JSON document."""
    columns = {name: column.tolist() for name, column in length_columns(found).items()}
    settings, error = found.settings, found.error_mm[found.is_measured]
    sides = settings.sides_mm
    return CertifyResult(
        outcome=found.outcome.value,
        n=len(error),
        lines=len(set(found.reference.line[found.is_measured].tolist())),
        largest_error_mm=float(found.error_mm[found.largest]),
        rms_error_mm=float(np.sqrt((error**2).mean())),
        limit_mm=settings.limit_mm,
        limit_ppm=settings.limit_ppm,
        rule=str(settings.rule),
        confidence=settings.confidence,
        uncertainty=str(settings.uncertainty),
        date=found.date,
        operator=settings.operator,
        temperature_c=settings.temperature_c,
        volume_mm=None if sides is None else sides.tolist(),
        lengths=[
            CertifiedLength(**dict(zip(columns, row, strict=True)))
            for row in zip(*columns.values(), strict=True)
        ],
        missing=list(found.measured.missing),
        warnings=list(found.warnings),
    )


@dataclass(frozen=True)
class PlannedLength:
    """A planned length in the JSON document, mm, in the frame of the volume's middle."""

    line: str
    length: str
    nominal_mm: float
    a_mm: list[float]
    b_mm: list[float]


@dataclass(frozen=True)
class PlanResult:
    """The JSON document of ``labcal certify --plan``."""

    file: str
    volume_mm: list[float]
    lengths: list[PlannedLength]
    warnings: list[str]


def plan_result(file: str, plan: LengthPlan) -> PlanResult:
    """Return the JSON document of a plan."""
    form = plan.lengths()
    names = zip(form.line.tolist(), form.length.tolist(), plan.nominal_mm.tolist(), strict=True)
    ends = zip(plan.end_a.tolist(), plan.end_b.tolist(), strict=True)
    lengths = [PlannedLength(*name, *end) for name, end in zip(names, ends, strict=True)]
    return PlanResult(file, list(plan.volume_mm), lengths, list(plan.warnings))


def plan_table(result: PlanResult, plan: LengthPlan) -> Group:
    """Return a plan for people."""
    table = Table("line", "length", "mm", "from (x, y, z)", "to (x, y, z)")
    for column in table.columns[2:]:
        column.justify = "right"
    for row in plan_rows(plan):
        table.add_row(*row)
    return Group(
        table,
        f"{result.file}: a form for these lengths. Ends count from the middle of the volume, mm. Measure "
        "each length in a view of its own, and put the calibrated value in the place of the planned one.",
    )


def rule_words(found: Certificate) -> str:
    """Return the decision rule in a sentence."""
    settings = found.settings
    if settings.rule == Rule.SIMPLE:
        return "Simple acceptance: errors are compared with their limit as they are."
    parts = {
        Uncertainty.REPEATED.value: "the noise of the pixels and that of the calibrated lengths",
        Uncertainty.REFERENCE.value: "that of the calibrated lengths",
    }
    return (
        f"ISO 14253-1: conformity, and non-conformity, is stated where it is proven with a probability of "
        f"{100 * settings.confidence:g}%. The uncertainty of the test is {parts[str(settings.uncertainty)]}."
    )


def outcome_words(found: Certificate) -> str:
    """Return the outcome in one sentence."""
    number = found.largest
    worst = (
        f"the largest error of {counted(int(found.is_measured.sum()), 'length')} is "
        f"{found.error_mm[number]:+.4f} mm (length {found.reference.length[number]} of line "
        f"{found.reference.line[number]})"
    )
    words = {
        Outcome.CONFORMING: "Conformity is proven",
        Outcome.NOT_CONFORMING: "Non-conformity is proven",
        Outcome.UNDECIDED: "Neither conformity nor non-conformity is proven",
        Outcome.INCOMPLETE: "The test is incomplete",
        Outcome.NO_LIMIT: "No limit is stated, so that nothing is decided",
    }
    if found.settings.rule == Rule.SIMPLE:
        words |= {
            Outcome.CONFORMING: "The errors conform",
            Outcome.NOT_CONFORMING: "The errors do not conform",
        }
    return f"{words[found.outcome]}: {worst}{limit_words(found)}."


def limit_words(found: Certificate) -> str:
    """Return the limit, at the end of a sentence; nothing where none is stated."""
    settings = found.settings
    if settings.limit_mm is None:
        return ""
    grows = f" + {settings.limit_ppm:g} ppm of the length" if settings.limit_ppm else ""
    return f", the limit {settings.limit_mm:g} mm{grows}"


def certificate_table(found: Certificate) -> Group:
    """Return the document for people, within 80 columns."""
    table = Table("line", "length", "calibrated", "error", "noise", "reference", "outcome")
    for column in table.columns[2:6]:
        column.justify = "right"
    columns = length_columns(found)
    for number in range(len(found.reference)):
        cells = [_cell(columns[name][number], form) for name, form in _FIGURES.items()]
        line, length, outcome = (str(columns[name][number]) for name in ("line", "length", "outcome"))
        table.add_row(line, length, *cells, outcome)
    return Group(table, outcome_words(found), "" if found.settings.limit_mm is None else rule_words(found))


_FIGURES = {"nominal_mm": ".3f", "error_mm": "+.4f", "noise_sigma_mm": ".4f", "reference_sigma_mm": ".4f"}


def _cell(value: float, form: str) -> str:
    return "-" if np.isnan(value) else format(float(value), form)
