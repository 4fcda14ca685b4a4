"""The explanations of rows 17 to 23, in a terminal."""

from collections.abc import Iterator

from rich.box import SIMPLE_HEAD
from rich.console import Group, RenderableType
from rich.table import Column, Table
from rich.text import Text

from labcal.report.explanations import CauseResult, Explanations
from labcal.report.explanations_words import (
    cause_sentences,
    divisor_sentences,
    given_rows,
    length_words,
    rows_words,
    size_words,
    summary_sentences,
)
from labcal.report.figure_readings import FigureReading
from labcal.report.figures_text import signed_metres

_NOTE = (
    "Solved for on the dots that were detected in the rendered pictures: the size of each mistake at which "
    "our error has the magnitude that the paper prints, the median of the seeds with their range."
)


def explanations_table(explanations: Explanations) -> RenderableType:
    """Return every cause with its sizes, and the divisors; a terminal of 80 columns holds it."""
    parts: list[RenderableType] = [Text("What would explain rows 17 to 23", style="bold"), Text("")]
    parts += [*(Text(sentence) for sentence in summary_sentences(explanations)), Text("")]
    for cause in explanations.causes:
        parts += [Text(f"{cause.cause}: {cause.words}"), _sizes(cause)]
        parts += [*(Text(sentence) for sentence in cause_sentences(cause)), Text("")]
    parts += [Text("a unit or a length that our error was divided by"), _divisors(explanations)]
    parts += [*(Text(sentence) for sentence in divisor_sentences(explanations)), Text("")]
    return Group(*parts, Text(_NOTE))


def _sizes(cause: CauseResult) -> Table:
    table = _table("row", "method", "paper, m", "as mean signed error", "as RMS of a coordinate")
    for exp, method in dict.fromkeys((row.exp, row.method) for row in cause.rows):
        of_row = {row.figure: row for row in cause.rows if (row.exp, row.method) == (exp, method)}
        cells = [size_words(of_row[figure], cause) if figure in of_row else "" for figure in FigureReading]
        paper = next(signed_metres(row.paper_m) for row in of_row.values())
        table.add_row(exp, Text(method), paper, *map(Text, cells))
    return table


def _divisors(explanations: Explanations) -> Table:
    table = _table("divisor", "mm", "as mean signed error", "as RMS of a coordinate")
    for one in explanations.divisors:
        rows: Iterator[str] = (rows_words(given_rows(one, figure)) for figure in FigureReading)
        table.add_row(Text(one.divisor), length_words(one), *rows)
    return table


def _table(*heads: str) -> Table:
    columns = [Column(head, overflow="fold") for head in heads]
    return Table(*columns, box=SIMPLE_HEAD, pad_edge=False, show_edge=False, padding=(0, 1, 0, 0))
