"""Figures of protocols as a tidy table, and for people."""

from collections.abc import Iterator, Sequence

import numpy as np
from rich.table import Table

from labcal.bench.distortion.protocols.number_words import number_words
from labcal.bench.distortion.protocols.registry import protocol_by_name
from labcal.bench.distortion.protocols.result import Found, ProtocolFigure, ProtocolResult, by_method
from labcal.run.tables import table_text

HEADER = ("protocol", "origin", "method", "seed", "quantity", "unit", "value", "reason")
"""The columns of ``protocols.csv``."""
MEASURED, PUBLISHED = "measured", "published"
"""Origins of a value."""
_NAN = float("nan")
_MORE = "What is the same there, and what is not, stands in results.json."


def protocols_table(found: Sequence[Found]) -> str:
    """Return the text of ``protocols.csv``: a line for each protocol, method, seed and quantity.

    Published figures are lines without a seed.
    """
    lines: list[tuple[object, ...]] = []
    for name in dict.fromkeys(case.protocol for case, _ in found):
        lines += _published(name)
    for one in found:
        lines += _measured(one)
    return table_text(HEADER, lines)


def _published(name: str) -> Iterator[tuple[object, ...]]:
    protocol = protocol_by_name(name)
    units = {quantity.name: quantity.unit for quantity in protocol.quantities}
    for one in protocol.published:
        yield (name, PUBLISHED, one.method, "", one.quantity, units[one.quantity], one.value, one.words)


def _measured(found: Found) -> Iterator[tuple[object, ...]]:
    case, figures = found
    quantities = protocol_by_name(case.protocol).quantities
    for one in by_method(case, figures):
        for at, quantity in enumerate(quantities):
            value = one.values[at] if one.reason is None else _NAN
            yield (
                *(case.protocol, MEASURED, one.method, case.seed),
                *(quantity.name, quantity.unit, value, one.reason or ""),
            )
        yield (
            case.protocol,
            MEASURED,
            one.method,
            case.seed,
            "coverage95",
            "1",
            one.coverage95,
            one.reason or "",
        )


def protocol_table(result: ProtocolResult) -> Table:
    """Return the figures of a protocol beside the published ones, for people."""
    table = Table(title=f"Protocol {result.protocol}: median over the seeds")
    table.add_column("method", overflow="fold")
    quantities = [(one.quantity, one.unit) for one in result.methods[0].figures]
    for name, unit in quantities:
        table.add_column(name + ("" if unit == "1" else f", {unit}"), justify="right")
    for one in result.methods:
        flag = "*" if one.flagged == one.seeds else ""
        table.add_row(one.method + flag, *map(_cell, one.figures))
    table.add_section()
    for method in dict.fromkeys(one.method for one in result.published):
        values = {one.quantity: one.value for one in result.published if one.method == method}
        cells = [f"{values[name]:.3g}" if name in values else "" for name, _ in quantities]
        table.add_row(f"published: {method}", *cells, style="dim")
    words = [f"{one.quantity}: {one.words}." for one in result.published if one.words]
    flagged = any(one.flagged == one.seeds for one in result.methods)
    legend = ["*: flagged model-misfit, from training data alone."] if flagged else []
    table.caption = "\n".join([*legend, f"Published in {result.source}.", *words, _MORE])
    table.caption_justify = "left"
    return table


def _cell(one: ProtocolFigure) -> str:
    if not np.isfinite(one.median):
        return "-"
    return number_words(one.median, one.unit)
