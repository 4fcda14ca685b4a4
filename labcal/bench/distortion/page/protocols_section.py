"""Section: protocols of others, beside the figures that they published."""

from collections.abc import Sequence

import numpy as np

from labcal.bench.distortion.page.findings import Findings
from labcal.bench.distortion.protocols.number_words import number_words
from labcal.bench.distortion.protocols.result import ProtocolFigure, ProtocolResult
from labcal.report.page.document import Section
from labcal.report.page.download import table_download
from labcal.report.page.part import Part
from labcal.report.page.prose import Prose, Terms
from labcal.report.page.table import MISSING, Column, PageTable, Side

_HOW = (
    "All methods by the protocols of others, so that figures compare: medians over the seeds, their range in "
    "brackets, and what the authors published. 'Exact cameras' is the oracle, which "
    "triangulates the same pixels with the true cameras."
)
_HEADER = ("method", "quantity", "unit", "median", "low", "high")


def protocols_section(findings: Findings) -> Section | None:
    """Return a table for each protocol, and what is the same as in the publication and what is not.

    Parameters
    ----------
    findings : Findings
    """
    results = findings.result.protocols
    if not results:
        return None
    parts: list[Part] = [Prose((_HOW,))]
    for result in results:
        parts += [_table(result), Terms(tuple(_statements(result)))]
    return Section("By the protocols of others", parts)


def _table(result: ProtocolResult) -> PageTable:
    quantities = [(one.quantity, one.unit) for one in result.methods[0].figures]
    rows = [[one.method, *map(_cell, one.figures)] for one in result.methods]
    for method in dict.fromkeys(one.method for one in result.published):
        values = {
            one.quantity: number_words(one.value, one.unit)
            for one in result.published
            if one.method == method
        }
        rows.append([f"published: {method}", *(values.get(name, MISSING) for name, _ in quantities)])
    columns = [
        Column("method", Side.LEFT),
        *(Column(name if unit == "1" else f"{name} ({unit})") for name, unit in quantities),
    ]
    lines = [
        (one.method, figure.quantity, figure.unit, figure.median, figure.low, figure.high)
        for one in result.methods
        for figure in one.figures
    ]
    file = table_download(f"protocol-{result.protocol}.csv", _HEADER, list(zip(*lines, strict=True)))
    return PageTable(
        f"protocol-{result.protocol}", f"{result.protocol}: {result.source}", columns, rows, file
    )


def _statements(result: ProtocolResult) -> list[tuple[str, str]]:
    """Return what the figures can be compared by."""
    published = [f"{one.quantity}: {one.words}." for one in result.published if one.words]
    return [
        (term, _joined(lines))
        for term, lines in (
            ("published", published),
            ("the same", result.same),
            ("not the same", result.different),
        )
        if lines
    ]


def _joined(lines: Sequence[str]) -> str:
    sentences = (line if line.endswith(".") else f"{line}." for line in lines)
    return " ".join(line[:1].upper() + line[1:] for line in sentences)


def _cell(one: ProtocolFigure) -> str:
    if not np.isfinite(one.median):
        return MISSING
    middle, low, high = (number_words(each, one.unit) for each in (one.median, one.low, one.high))
    return middle if low == high else f"{middle} ({low} to {high})"
