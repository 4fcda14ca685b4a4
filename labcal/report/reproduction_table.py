"""The paper's figures beside ours, in a terminal of any width."""

from collections.abc import Callable, Iterator
from dataclasses import dataclass

from rich.box import SIMPLE_HEAD
from rich.console import Console, ConsoleOptions, RenderableType
from rich.table import Table
from rich.text import Text

from labcal.report.figures_text import MISSING, epochs, goal, millimetres, percent, signed_metres
from labcal.report.reproduction import Reproduction, RowResult
from labcal.report.row_verdict import RowVerdict

CONTRADICTION_MARK = "!"
GOAL_MARK = "*"
_GAP = 2  # blanks between columns
_STYLES = {
    RowVerdict.MATCHES: "green",
    RowVerdict.OTHER_EPOCHS: "yellow",
    RowVerdict.SMALLER: "yellow",
    RowVerdict.LARGER: "red",
    RowVerdict.CONTRADICTION: "magenta",
}


@dataclass(frozen=True)
class _Column:
    """A column, and when it goes where there is little room: those of the highest rank first."""

    heading: str
    rank: int
    cell: Callable[[RowResult], str]
    right: bool = True

    def width(self, rows: tuple[RowResult, ...]) -> int:
        """Return the room it takes."""
        cells = [*self.heading.split("\n"), *(self.cell(row) for row in rows)]
        return max(len(cell) for cell in cells) + _GAP


def _mark(row: RowResult) -> str:
    return row.exp + (CONTRADICTION_MARK if row.contradiction else "")


def _solver(row: RowResult) -> str:
    return f"{row.solver} {row.network or row.reading.partition(',')[0]}"


def _epochs(row: RowResult) -> str:
    return epochs(row.epochs) + (GOAL_MARK if row.goal_reached is False else "")


def _short_verdict(row: RowResult) -> str:
    return row.verdict.short


_COLUMNS = (
    _Column("exp", 0, _mark, right=False),
    _Column("solver", 0, _solver, right=False),
    _Column("data", 1, lambda row: row.data, right=False),
    _Column("points", 4, lambda row: str(row.points)),
    _Column("goal", 8, lambda row: goal(row.goal)),
    _Column("mean, m\nours", 0, lambda row: signed_metres(row.mean_signed_m)),
    _Column("\npaper", 0, lambda row: signed_metres(row.paper_abs_m)),
    _Column("relative\nours", 3, lambda row: percent(row.rel)),
    _Column("\npaper", 3, lambda row: percent(row.paper_rel)),
    _Column("epochs\nours", 0, _epochs),
    _Column("\npaper", 0, lambda row: epochs(row.paper_epochs)),
    _Column("mean length\nmm", 7, lambda row: millimetres(row.mae_mm)),
    _Column("RMS\nmm", 0, lambda row: millimetres(row.rmse_mm)),
    _Column("P95\nmm", 6, lambda row: millimetres(row.p95_mm)),
    _Column("max\nmm", 2, lambda row: millimetres(row.max_mm)),
    _Column("time\ns", 9, lambda row: f"{row.seconds:.1f}"),
    _Column("verdict", 0, _short_verdict, right=False),
)


@dataclass(frozen=True)
class _ReproductionTable:
    """A table that leaves columns out until it fits."""

    result: Reproduction

    def __rich_console__(self, console: Console, options: ConsoleOptions) -> Iterator[RenderableType]:
        """Yield the table and its footnotes."""
        result = self.result
        columns = _fitting(result.rows, options.max_width)
        table = Table(box=SIMPLE_HEAD, pad_edge=False, show_edge=False, padding=(0, _GAP - 1, 0, 0))
        for column in columns:
            table.add_column(
                column.heading,
                justify="right" if column.right else "left",
                no_wrap=column.heading not in {"verdict", "data"},
            )
        rows: tuple[RowResult | str, ...] = (*result.rows, *result.not_reported)
        for row in sorted(rows, key=_number):
            if isinstance(row, str):
                missing = {"exp": row, "verdict": "not reported"}
                table.add_row(*(missing.get(column.heading, MISSING) for column in columns), style="dim")
            else:
                style = _STYLES[row.verdict]
                cells = [Text(column.cell(row)) for column in columns]
                cells[-1].stylize(style)
                table.add_row(*cells)
        yield table
        for mark, note in _notes(result):
            line = Table.grid(padding=(0, 1, 0, 0))
            line.add_row(mark, Text(note))
            if not mark.isdigit():
                yield Text("")
            yield line if mark else Text(note)


def reproduction_table(result: Reproduction) -> _ReproductionTable:
    """Return the rows beside the paper's, as rich shows them.

    Where there is little room columns go, the least telling first; those with the errors that the paper
    prints, the RMS error that it hides and the verdict stay. At 80 columns everything that stays fits.

    Parameters
    ----------
    result : Reproduction

    Returns
    -------
    rich renderable
    """
    return _ReproductionTable(result)


def _number(row: RowResult | str) -> str:
    return row if isinstance(row, str) else row.exp


def _fitting(rows: tuple[RowResult, ...], width: int) -> tuple[_Column, ...]:
    """Return the columns that there is room for, the most telling ones at least."""
    rank = max(column.rank for column in _COLUMNS)
    while rank > 0 and sum(column.width(rows) for column in _COLUMNS if column.rank <= rank) > width:
        rank -= 1
    return tuple(column for column in _COLUMNS if column.rank <= rank)


def _notes(result: Reproduction) -> list[tuple[str, str]]:
    """Return what is to be said below the table: a mark of the table or none, and what it means."""
    notes = []
    if result.quick:
        notes.append(("", "Quick run, not the paper's conditions: " + "; ".join(result.restrictions) + "."))
    seeds = sorted({row.seeds for row in result.rows})
    counts = " to ".join(map(str, dict.fromkeys(seeds[:1] + seeds[-1:])))
    runs = "one run each" if seeds == [1] else f"medians of {counts} runs"
    scored = (
        f"Scored on points that were not trained on, {runs}. mean: predicted minus true with its sign, over "
        "all points and coordinates: the paper's figure, in which errors cancel. RMS, P95 and max: of the "
        "length of the 3-D error."
    )
    notes.append(("", scored))
    if any(row.goal_reached is False for row in result.rows):
        notes.append((GOAL_MARK, "The goal of the training was not reached."))
    if any(row.contradiction for row in result.rows):
        notes.append((CONTRADICTION_MARK, "The paper contradicts itself:"))
        notes += [(row.exp, row.contradiction) for row in result.rows if row.contradiction]
    return notes
