"""Lines of a table by columns: numbers are checked together, and the first damaged line is reported."""

import re
from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass, field
from functools import cached_property
from itertools import islice
from pathlib import Path

import numpy as np
from jaxtyping import Bool, Float64, Int64

from labcal.errors import InputError
from labcal.run.file_reading import MOST_OF_A_TABLE, read_bytes
from labcal.run.plain_table import plain_columns
from labcal.run.tables import LONGEST_LINE, MOST_LINES, damaged_line, read_lines
from labcal.wording import clipped

_TOGETHER = 2**11
"""Lines."""
_MOST_OF_NAMES = 2**29
"""Bytes of a column of names, which NumPy keeps with as many letters a line as the longest has."""
_MOST_WHOLE = 2**53
"""Of a whole number; far beyond any index or side, and within what float64 and int64 hold."""


@dataclass
class TableLines:
    """Some lines of a table, and the faults found in them so far."""

    path: Path
    first: int
    """Number of the first line, counted from 0 after the header."""
    header: Sequence[str]
    columns: Sequence[Sequence[str]]
    """The cells, column by column."""
    faults: list[tuple[int, str]] = field(default_factory=list)
    """Line (counted from 0 here) and reason; of each check the first."""

    def __len__(self) -> int:
        return len(self.columns[0])

    @cached_property
    def lines(self) -> list[tuple[str, ...]]:
        """The cells, line by line."""
        return list(zip(*self.columns, strict=True))

    def column(self, name: str) -> Sequence[str]:
        """Return the cells of a column."""
        return self.columns[self.header.index(name)]

    def figures(self, names: Sequence[str], empty: str | None = None) -> Float64[np.ndarray, "n columns"]:
        """Return columns of numbers, with a substitute for empty cells; NaN at a fault."""
        return np.stack([self._numbers(name, float, np.nan, empty) for name in names], axis=1)

    def whole(self, names: Sequence[str], empty: str | None = None) -> Int64[np.ndarray, "n columns"]:
        """Return columns of whole numbers, with a substitute for empty cells; -1 at a fault."""
        columns = [self._numbers(name, _whole, -1.0, empty) for name in names]
        return np.stack(columns, axis=1).astype(np.int64)

    def require(self, holds: Bool[np.ndarray, " n"], why: str) -> None:
        """Record a fault at the first line that does not meet a condition."""
        if not holds.all():
            self.faults.append((int(np.argmin(holds)), why))

    def refuse(self) -> None:
        """Raise if a fault was recorded.

        Raises
        ------
        InputError
            The first such line is named, with what was noted first about it.
        """
        if self.faults:
            at, why = min(self.faults, key=lambda fault: fault[0])  # of equal ones the first
            raise damaged_line(self.path, self.first + at, self.lines[at], why)

    def _numbers(
        self, name: str, number: Callable[[str], float], other: float, empty: str | None = None
    ) -> np.ndarray:
        cells = self.column(name)
        if empty is not None and "" in cells:
            cells = tuple(cell or empty for cell in cells)
        try:
            if _is_odd("".join(cells)):
                raise ValueError(name)  # noqa: TRY301 -- which cell it is comes out below
            return np.array(list(map(number, cells)))
        except (ValueError, OverflowError):
            values = np.full(len(cells), other)
            for at, cell in enumerate(cells):
                try:
                    if _is_odd(cell):
                        raise ValueError(cell)  # noqa: TRY301 -- as what Python takes for no number
                    values[at] = number(cell)
                except (ValueError, OverflowError):
                    kind = "whole number" if number is _whole else "number"
                    self.faults.append((at, f"{name} '{clipped(cell, 20)}' is no {kind}"))
                    break  # what is behind it does not matter any more
            return values


_STRANGE_SPACE = re.compile(r"[\v\f\x1c-\x1f]")


def _is_odd(cell: str) -> bool:
    """Tell whether Python alone would take a cell for a number: ``1_0``, digits or spaces of other kinds."""
    return "_" in cell or not cell.isascii() or _STRANGE_SPACE.search(cell) is not None


def _whole(cell: str) -> int:
    value = int(cell)
    if abs(value) > _MOST_WHOLE:
        raise OverflowError
    return value


def table_parts(
    header: Sequence[str], what: str, path: Path, most: int = MOST_OF_A_TABLE
) -> Iterator[TableLines]:
    """Yield the lines of a table, many at a time; parameters and errors are those of :func:`read_table`."""
    data, first = read_bytes(path, what, most), 0
    plain = plain_columns(header, data, MOST_LINES, LONGEST_LINE)
    if plain is not None:
        for columns in plain:
            yield TableLines(path, first, header, columns)
            first += len(columns[0])
        return
    lines = read_lines(header, what, path, data)
    while part := list(_until_bad(lines, _TOGETHER)):
        good = [line for line in part if not isinstance(line, InputError)]
        if good:
            yield TableLines(path, first, header, list(zip(*good, strict=True)))
        if isinstance(part[-1], InputError):  # the lines before it were good
            raise part[-1]
        first += len(part)


def _until_bad(lines: Iterator[list[str]], most: int) -> Iterator[list[str] | InputError]:
    """Yield lines, and for a line that cannot be read the reason."""
    try:
        yield from islice(lines, most)
    except InputError as error:
        yield error


def numbers_of_names(names: Sequence[str], known: dict[str, int]) -> Int64[np.ndarray, " n"]:
    """Return the number of every name; names that are not known yet get the next ones."""
    if len(names) and names.count(names[0]) == len(names):  # of one view, or camera
        return np.full(len(names), known.setdefault(names[0], len(known)), dtype=np.int64)
    new = [name for name in dict.fromkeys(names) if name not in known]
    known.update(zip(new, range(len(known), len(known) + len(new)), strict=True))
    return np.fromiter(map(known.__getitem__, names), dtype=np.int64, count=len(names))


def names_of_lines(path: Path, names: Sequence[str], lines: Int64[np.ndarray, " n"]) -> np.ndarray:
    """Return the name of every line as an array of str.

    Parameters
    ----------
    path : Path
        Of the table, for messages.
    names : sequence of str
        Each of them once.
    lines : ndarray of int, shape (n,)
        The number of every line's name.

    Raises
    ------
    InputError
        A name is so long that the column would take more than :data:`_MOST_OF_NAMES`.
    """
    longest = max(map(len, names), default=1)
    if 4 * longest * len(lines) > _MOST_OF_NAMES:
        raise InputError(
            f"{path} has {len(lines)} lines, and a name of {longest} letters among them: too much to hold. "
            "Use shorter names, or split the table by views."
        )
    return np.asarray(np.array(names or [""], dtype=np.str_)[lines])
