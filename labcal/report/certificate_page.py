"""The certificate of ``labcal certify``: outcome, circumstances, errors and lengths."""

import numpy as np
from matplotlib.figure import Figure

from labcal.cameras.rig import Rig
from labcal.evaluate.acceptance.certificate import Certificate, length_columns
from labcal.evaluate.acceptance.certificate_figure import draw_errors
from labcal.evaluate.acceptance.decision import Outcome
from labcal.paths import AnyPath
from labcal.report.certify_result import certify_result, limit_words, outcome_words, rule_words
from labcal.report.inline_svg import OURS, SECOND, inline_svg, page_style
from labcal.report.page.chart import Chart
from labcal.report.page.document import Page, Paper, Section
from labcal.report.page.download import table_download
from labcal.report.page.part import Part
from labcal.report.page.prose import Prose, Terms
from labcal.report.page.table import MISSING, Column, PageTable, Side
from labcal.report.page.written import Written
from labcal.report.page_axes import plain_axes
from labcal.report.page_maker import PageMaker

_TONES = {Outcome.CONFORMING: "good", Outcome.NOT_CONFORMING: "bad", Outcome.NO_LIMIT: "plain"}
_GUIDELINE = (
    "After published descriptions of VDI/VDE 2634 Part 1: seven measuring lines with five lengths each, the "
    "error of a length as measured minus calibrated, and its largest absolute value against a limit. The "
    "division of the uncertainty into noise, reference and calibration, and the guard bands, are labcal's."
)
_ERRORS = "Errors of the lengths. Bars: two standard deviations by noise and reference. Lines: the limit."


def certificate_page(found: Certificate, rig: Rig | AnyPath | None, maker: PageMaker) -> Page:
    """Return the certificate.

    Parameters
    ----------
    found : Certificate
    rig : Rig or path, optional
        What measured.
    maker : PageMaker
    """
    values = {"tone": _TONES.get(found.outcome, "fair"), "sentence": outcome_words(found)}
    return Page(
        title="Certificate of length errors",
        heading="Acceptance test: errors of lengths",
        lead="In the manner of VDI/VDE 2634 Part 1.",
        sections=[
            Section("Circumstances", [Terms(tuple(_terms(found, rig, maker)))]),
            Section("Errors", [_chart(found), _table(found), *_notes(found, maker)]),
        ],
        provenance=maker.provenance,
        opening=[Written("certificate_outcome.html.jinja", values)],
        paper=Paper.PORTRAIT,
    )


def _notes(found: Certificate, maker: PageMaker) -> list[Part]:
    return [*maker.notes(found.warnings), Prose((_GUIDELINE,)), Written("signature.html.jinja", {})]


def _terms(found: Certificate, rig: Rig | AnyPath | None, maker: PageMaker) -> list[tuple[str, str]]:
    """Return what the test was made with, when and by whom, and how it was decided."""
    settings, result = found.settings, certify_result(found)
    terms = [("Date", found.date)]
    if settings.operator is not None:
        terms.append(("Operator", settings.operator))
    if settings.temperature_c is not None:
        terms.append(("Temperature", f"{settings.temperature_c:g} degrees Celsius"))
    terms.append(("Rig", _rig(rig, maker)))
    if settings.sides_mm is not None:
        terms.append(("Volume", " x ".join(f"{side:g}" for side in settings.sides_mm.tolist()) + " mm"))
    lengths = found.reference.nominal_mm[found.is_measured]
    reach = f"{lengths.min():.4g} to {lengths.max():.4g} mm"
    rms = f"RMS error {result.rms_error_mm:.4f} mm"
    terms.append(("Lengths", f"{result.n} on {result.lines} lines, {reach}; {rms}"))
    expected = found.expected_sigma_mm[found.is_measured]
    if np.isfinite(expected).all():
        rms = f"RMS error {np.sqrt((expected**2).mean()):.4f} mm"
        terms.append(("Expected", f"{rms} by the budget of noise, calibration and reference"))
    limit = limit_words(found)
    terms.append(("Limit", f"{limit.removeprefix(', the limit ')}" if limit else "none stated"))
    if limit:
        terms.append(("Decision rule", rule_words(found)))
    return terms


def _rig(rig: Rig | AnyPath | None, maker: PageMaker) -> str:
    """Return the rig by its file and digest, or by its cameras."""
    if rig is None:
        return "not stated"
    if isinstance(rig, Rig):
        return f"cameras {', '.join(rig.cameras)}, from no file"
    digest = maker.provenance.inputs.get(str(rig), "")
    return f"{rig}, SHA-256 {digest}" if digest else str(rig)


def _chart(found: Certificate) -> Chart:
    with page_style():
        figure = Figure(figsize=(7.4, 2.7), layout="constrained")
        axes = figure.add_subplot()
        draw_errors(axes, found, (OURS.drawn, SECOND.drawn))
        plain_axes(axes)
        svg = inline_svg(figure, "errors", "Errors of lengths with their uncertainty, and the limit")
    columns = {name: column.tolist() for name, column in length_columns(found).items()}
    return Chart(
        "errors-chart", svg, _ERRORS, table_download("lengths.csv", list(columns), [*columns.values()])
    )


def _table(found: Certificate) -> PageTable:
    """Return the lengths."""
    columns = length_columns(found)
    shown = {
        "nominal_mm": ".3f", "measured_mm": ".4f", "error_mm": "+.4f", "noise_sigma_mm": ".4f",
        "reference_sigma_mm": ".4f", "calibration_sigma_mm": ".4f", "limit_mm": ".4f",
    }  # fmt: skip
    rows = []
    for number in range(len(found.reference)):
        values = [float(columns[name][number]) for name in shown]
        cells = [
            MISSING if np.isnan(x) else format(x, form)
            for x, form in zip(values, shown.values(), strict=True)
        ]
        line, length, outcome = (str(columns[name][number]) for name in ("line", "length", "outcome"))
        rows.append([f"{line} / {length}", *cells, outcome])
    heads = [
        Column("line / length", Side.LEFT), Column("calibrated"), Column("measured"), Column("error"),
        Column("noise", meaning="standard deviation by the noise of the pixels"),
        Column("reference", meaning="standard uncertainty of the calibrated length"),
        Column("calibration", meaning="standard deviation by the errors of the cameras' calibration"),
        Column("limit"), Column("outcome", Side.LEFT),
    ]  # fmt: skip
    return PageTable("lengths", "Lengths and their standard uncertainties, mm.", heads, rows)
