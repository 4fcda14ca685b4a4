"""Words about what would explain rows 17 to 23, for the terminal, the page and the documentation."""

import math
from collections.abc import Iterable, Sequence

from labcal.report.explanations import CauseResult, DivisorResult, ExplainedRow, Explanations, QuotientRow
from labcal.report.figure_readings import FigureReading
from labcal.report.figures_text import millimetres, signed_metres


def size_words(row: ExplainedRow, cause: CauseResult) -> str:
    """Return the size that a row needs, with the range of the seeds, or the greatest that was not enough."""
    if math.isnan(row.size):
        some = f", {row.solved} of {row.seeds} seeds" if row.solved else ""
        return f"none up to {_number(cause.greatest)} {cause.unit}{some}"
    low, high = row.size_range
    median = f"{_number(row.size)} {cause.unit}"
    if row.seeds == 1 or low == high:
        return median
    return f"{median} ({_number(low)} to {'beyond' if math.isnan(high) else _number(high)})"


def greatest_words(row: ExplainedRow) -> str:
    """Return the greatest error that was met, m."""
    return signed_metres(row.greatest_m).removeprefix("+")


def likely_words(row: ExplainedRow) -> str:
    """Return whether the size is one that an experimenter may have."""
    if math.isnan(row.size):
        return ""
    return "yes" if row.likely else "no"


def rows_words(rows: Iterable[str]) -> str:
    """Return numbers of rows, or a dash."""
    return ", ".join(rows) or "-"


def summary_sentences(explanations: Explanations) -> list[str]:
    """Return whether one mistake gives all rows, and which rows a mistake of a likely size gives.

    Parameters
    ----------
    explanations : Explanations
    """
    solved = [(cause, row) for cause in explanations.causes for row in cause.rows if not math.isnan(row.size)]
    every = sorted({row.exp for cause in explanations.causes for row in cause.rows})
    if not solved:
        return ["No mistake of any size that was tried gives any row."]
    cause, most = max(solved, key=lambda one: len(one[1].also_gives))
    together = sorted({most.exp, *most.also_gives})
    at = f"{', '.join(together)} ({cause.cause}, {size_words(most, cause)}, figure read as {most.figure})"
    if together == every:
        common = f"One mistake of one size gives all rows: {at}."
    elif len(together) == 1:
        common = f"No mistake of one size gives two of the {len(every)} rows."
    else:
        common = f"No mistake of one size gives all {len(every)} rows; at most rows {at}."
    likely: dict[str, dict[str, None]] = {}
    for cause, row in solved:
        if row.likely:
            likely.setdefault(f"{cause.cause}, figure read as {row.figure}", {})[row.exp] = None
    if not likely:
        return [common, "No mistake of a likely size gives any row."]
    given = {exp for rows in likely.values() for exp in rows}
    missing = [exp for exp in every if exp not in given]
    words = "; ".join(f"{name}: {rows_words(rows)}" for name, rows in likely.items())
    none = f" Rows that no likely size gives: {rows_words(missing)}." if missing else ""
    return [common, f"Rows that a mistake of a likely size gives: {words}.{none}"]


def cause_sentences(cause: CauseResult) -> list[str]:
    """Return for every reading of the printed figure which rows a cause gives, and at which sizes.

    Parameters
    ----------
    cause : CauseResult
    """
    return [
        _cause_sentence(cause, figure, [row for row in cause.rows if row.figure == figure])
        for figure in FigureReading
    ]


def _cause_sentence(cause: CauseResult, figure: str, rows: Sequence[ExplainedRow]) -> str:
    given = _least_sizes(rows)
    missing = [exp for exp in dict.fromkeys(row.exp for row in rows) if exp not in given]
    start = f"Read as {figure}: "
    if not given:
        return f"{start}no size up to {_number(cause.greatest)} {cause.unit} gives any row."
    sizes = ", ".join(f"{exp} at {_number(row.size)} {cause.unit}" for exp, row in given.items())
    likely = [exp for exp, row in given.items() if row.likely]
    low, high = (f"{size:g}" for size in cause.likely)
    words = f"{start}row {sizes}; of a likely size ({low} to {high} {cause.unit}): {_or_none(likely)}"
    most = max(given.values(), key=lambda row: len(row.also_gives))
    shared = f"One size gives at most {len(most.also_gives) + 1} of {len(given) + len(missing)} rows"
    at = f" ({', '.join(sorted((most.exp, *most.also_gives)))} at {_number(most.size)} {cause.unit})"
    return f"{words}. {shared}{at if most.also_gives else ''}."


def divisor_sentences(explanations: Explanations) -> list[str]:
    """Return for every reading of the printed figure which unit or length gives most rows.

    Parameters
    ----------
    explanations : Explanations
    """
    return [_divisor_sentence(explanations.divisors, figure) for figure in FigureReading]


def _divisor_sentence(divisors: Sequence[DivisorResult], figure: FigureReading) -> str:
    most = max(len(given_rows(one, figure)) for one in divisors)
    if not most:
        return f"Read as {figure}: no unit and no length gives any row."
    best = [one for one in divisors if len(given_rows(one, figure)) == most]
    names = "; ".join(f"{one.divisor} (rows {rows_words(given_rows(one, figure))})" for one in best)
    return f"Read as {figure}: most rows, {most}, are given by: {names}."


def given_rows(divisor: DivisorResult, figure: FigureReading) -> tuple[str, ...]:
    """Return the rows that a division gives under a reading of the printed figure."""
    return divisor.mean_signed_rows if figure is FigureReading.MEAN_SIGNED else divisor.coordinate_rows


def length_words(divisor: DivisorResult) -> str:
    """Return a length, or its range over the scenes."""
    low, high = millimetres(divisor.least_mm), millimetres(divisor.greatest_mm)
    return low if low == high else f"{low} to {high}"


def quotient_words(quotient: QuotientRow) -> str:
    """Return the length by which our error must be divided, with the range of seeds and methods."""
    low, high = (millimetres(end) for end in quotient.quotient_range_mm)
    median = millimetres(quotient.quotient_mm)
    return median if low == high else f"{median} ({low} to {high})"


def _least_sizes(rows: Sequence[ExplainedRow]) -> dict[str, ExplainedRow]:
    """Return the rows that a size gives, by number: the method that needs least."""
    found: dict[str, ExplainedRow] = {}
    for row in rows:
        if not math.isnan(row.size) and (row.exp not in found or row.size < found[row.exp].size):
            found[row.exp] = row
    return found


def _or_none(names: Sequence[str]) -> str:
    return f"row {', '.join(names)}" if names else "none"


def _number(value: float) -> str:
    """Return a size with two significant digits."""
    return f"{value:.{max(0, 1 - math.floor(math.log10(value)))}f}" if 0 < value < 10 else f"{value:.0f}"  # noqa: PLR2004 -- two digits
