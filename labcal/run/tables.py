"""CSV files with a fixed first line."""

import csv
import io
import re
from collections.abc import Iterable, Iterator, Sequence
from pathlib import Path

import numpy as np
from jaxtyping import Int64

from labcal.errors import InputError
from labcal.run.file_reading import MOST_OF_A_TABLE, no_text, read_bytes
from labcal.run.float_texts import float_texts
from labcal.wording import clipped, counted

MOST_LINES = 2_000_000
"""Of a table: all the dots of thousands of pictures."""

_FORMULA = re.compile(r"'*[=+\-@\t\r]")
"""The beginning of a text that a spreadsheet would take for a formula, after any apostrophes."""
_UNUSUAL = re.compile(r"""[^\w.:;/+()'\-\n]""")
"""Letters for which a cell might need quotation marks or an apostrophe; a few more do no harm."""
_MOST_IN_A_LINE = 200
LONGEST_LINE = 2**17
"""Letters."""


def table_text(header: Sequence[str], lines: Iterable[Sequence[object]]) -> str:
    """Return the text of a table; floats are written so that they read back exactly.

    A text (not a number) that begins as a formula does (``=``, ``+``, ``-``, ``@``, tab or carriage return)
    gets an apostrophe in front, by which spreadsheets know a text; :func:`read_table` takes it off.
    """
    text = io.StringIO()
    writer = csv.writer(text, lineterminator="\n")
    writer.writerow(header)
    for line in lines:
        writer.writerow([_cell(value) for value in line])
    return text.getvalue()


def columns_text(header: Sequence[str], parts: Iterable[Sequence[Sequence[object] | np.ndarray]]) -> str:
    """Return the text of a table as :func:`table_text` does, from columns of many lines.

    Parameters
    ----------
    header : sequence of str
    parts : iterable of sequences of columns
        Some lines each: a column is a list of texts, one of numbers of Python's, or an array of floats.
    """
    text = io.StringIO()
    writer = csv.writer(text, lineterminator="\n")
    writer.writerow(header)
    for columns in parts:
        texts = [len(column) > 0 and isinstance(column[0], str) for column in columns]
        if all(_is_bare(column) for column, of_text in zip(columns, texts, strict=True) if of_text):
            written = [
                column if of_text else _number_texts(column)
                for column, of_text in zip(columns, texts, strict=True)
            ]
            text.writelines(
                ("\n".join(map(",".join, zip(*written, strict=True))), "\n" if len(columns[0]) else "")
            )
            continue
        cells = [
            list(map(_cell, column)) if of_text else _numbers(column)
            for column, of_text in zip(columns, texts, strict=True)
        ]
        writer.writerows(zip(*cells, strict=True))  # which writes floats as `repr` does
    return text.getvalue()


def _number_texts(column: Sequence[object] | np.ndarray) -> Iterable[str]:
    return float_texts(column) if isinstance(column, np.ndarray) else map(repr, column)


def _numbers(column: Sequence[object] | np.ndarray) -> Sequence[object]:
    return column.tolist() if isinstance(column, np.ndarray) else column


def _is_bare(column: Sequence[object] | np.ndarray) -> bool:
    """Tell whether the texts of a column are cells as they are, without apostrophes and quotation marks."""
    together = "\n".join(map(str, column))
    lines = together.count("\n") + 1
    return (
        lines == len(column)
        and _UNUSUAL.search(together) is None
        and "\n\n" not in f"\n{together}\n"
        and not any(f"\n{mark}" in f"\n{together}" for mark in "'+-")
    )


def _cell(value: object) -> object:
    """Return the text of a cell for a value."""
    if isinstance(value, float):
        return repr(value)
    return f"'{value}" if isinstance(value, str) and _FORMULA.match(value) else value


def _value(cell: str) -> str:
    """Return the value of a cell, without the apostrophe of a text."""
    return cell[1:] if cell[:1] == "'" and _FORMULA.match(cell) else cell


def read_table(
    header: Sequence[str], what: str, path: Path, most: int = MOST_OF_A_TABLE
) -> Iterator[list[str]]:
    """Yield the lines of a table after its header, as text; a damaged line raises when it is reached.

    A table may hold millions of lines, so that a reader should refuse a bad one when it has it in hand.

    Parameters
    ----------
    header : sequence of str
        What the first line must be.
    what : str
        What the table holds, for messages: ``"detections"``.
    path : Path
    most : int
        Bytes that the file may have.

    Yields
    ------
    list of str
        The cells of a line.

    Raises
    ------
    InputError
        The file cannot be read, has other columns, more than :data:`MOST_LINES` lines, or a line of it has
        not as many cells.
    """
    yield from read_lines(header, what, path, read_bytes(path, what, most))


def read_lines(header: Sequence[str], what: str, path: Path, data: bytes) -> Iterator[list[str]]:
    """Yield the lines of :func:`read_table` from the bytes of its file."""
    number = -1
    marked = b"'" in data  # else no cell is marked as a text
    try:
        with io.TextIOWrapper(io.BytesIO(data), encoding="utf-8-sig", newline="") as text:
            reader = csv.reader(_bounded_lines(text, path), strict=True)
            if next(reader, None) != list(header):
                raise InputError(
                    f"{path} is no table of {what}: its first line should be {','.join(header)}."
                )
            for number, line in enumerate(reader):
                if number == MOST_LINES:
                    raise InputError(f"{path} has more than {MOST_LINES} lines. Split the table by views.")
                if len(line) != len(header):
                    cells = counted(len(line), "cell")
                    raise damaged_line(path, number, line, f"it has {cells}, not {len(header)}")
                yield [_value(cell) for cell in line] if marked else line
    except UnicodeDecodeError as error:
        raise no_text(what, path, data) from error
    except csv.Error as error:
        raise InputError(f"The {what} {path} cannot be read: line {number + 3}: {error}.") from error


def _bounded_lines(text: Iterable[str], path: Path) -> Iterator[str]:
    """Yield the lines of a text with their ends as they are, which a cell in quotation marks may hold."""
    for line in text:
        if len(line) > LONGEST_LINE:
            raise InputError(f"{path} is no table: a line in it has {len(line)} characters.")
        yield line


def damaged_line(path: Path, number: int, line: Sequence[str], why: str = "") -> InputError:
    """Return the error for a damaged line; `number` counts from 0 after the header."""
    given = clipped(",".join(clipped(cell) for cell in line[:20]), _MOST_IN_A_LINE)
    return InputError(f"Line {number + 2} of {path} is damaged{why and f' ({why})'}: {given}")


def refuse_twice(path: Path, keys: Int64[np.ndarray, "n parts"], what: str) -> None:
    """Raise if two lines have the same key.

    Parameters
    ----------
    path : Path
        Of the table, for messages.
    keys : ndarray of int, shape (n, parts)
        A key a line; one with a negative part is that of no thing.
    what : str
        Of what there is one, for messages: ``"dot of a view"``.

    Raises
    ------
    InputError
        The first such line is named.
    """
    known = np.flatnonzero((keys >= 0).all(axis=1))
    order = known[np.lexsort(keys[known].T)]  # stable: equal keys stay in the order of their lines
    again = np.flatnonzero((keys[order[1:]] == keys[order[:-1]]).all(axis=1))
    if len(again):
        at = again[np.argmin(order[again + 1])]
        raise InputError(
            f"Line {order[at + 1] + 2} of {path} is of the same {what} as line {order[at] + 2}. "
            "Keep one of them."
        )
