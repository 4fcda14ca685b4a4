"""CSV files with a fixed first line."""

import csv
import io
import re
from collections.abc import Iterable, Iterator, Sequence
from pathlib import Path

from labcal.errors import InputError
from labcal.run.file_reading import MOST_OF_A_TABLE, read_text
from labcal.wording import clipped

_FORMULA = re.compile(r"'*[=+\-@\t\r]")
"""How a text begins that a spreadsheet would take for a formula, after any marks that it is a text."""
_MOST_IN_A_LINE = 200
_LONGEST_LINE = 2**17


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


def _cell(value: object) -> object:
    """Return what is written for a value."""
    if isinstance(value, float):
        return repr(value)
    return f"'{value}" if isinstance(value, str) and _FORMULA.match(value) else value


def _value(cell: str) -> str:
    """Return the text that a cell stands for."""
    return cell[1:] if cell.startswith("'") and _FORMULA.match(cell) else cell


def read_table(header: Sequence[str], what: str, path: Path) -> list[list[str]]:
    """Read the lines of a table after its header, as text.

    Parameters
    ----------
    header : sequence of str
        What the first line must be.
    what : str
        What the table holds, for messages: ``"detections"``.
    path : Path

    Raises
    ------
    InputError
        The file cannot be read, has other columns, or a line of it has not as many cells.
    """
    text = read_text(path, what, MOST_OF_A_TABLE)
    try:
        reader = csv.reader(_bounded_lines(text, path), strict=True)
        if next(reader, None) != list(header):
            raise InputError(f"{path} is no table of {what}: its first line should be {','.join(header)}.")
        lines = []
        for number, line in enumerate(reader):
            if len(line) != len(header):  # at once: a file may hold millions of them
                raise damaged_line(path, number, line)
            lines.append([_value(cell) if cell.startswith("'") else cell for cell in line])
    except csv.Error as error:
        raise InputError(f"The {what} {path} cannot be read: {error}.") from error
    return lines


def _bounded_lines(text: str, path: Path) -> Iterator[str]:
    """Yield the lines of a text with their ends as they are, which a cell in quotation marks may hold."""
    for line in io.StringIO(text, newline=""):
        if len(line) > _LONGEST_LINE:
            raise InputError(f"{path} is no table: a line in it has {len(line)} characters.")
        yield line


def damaged_line(path: Path, number: int, line: Sequence[str], why: str = "") -> InputError:
    """Return the error for a line that cannot be understood; `number` counts from 0 after the header."""
    given = clipped(",".join(clipped(cell) for cell in line[:20]), _MOST_IN_A_LINE)
    return InputError(f"Line {number + 2} of {path} is damaged{why and f' ({why})'}: {given}")


def refuse_twice(path: Path, keys: Sequence[object], what: str) -> None:
    """Raise where two lines are of the same thing; one key a line.

    Raises
    ------
    InputError
        The first such line is named.
    """
    if len(set(keys)) == len(keys):
        return
    first: dict[object, int] = {}
    for number, key in enumerate(keys):
        known = first.setdefault(key, number)
        if known != number:
            raise InputError(
                f"Line {number + 2} of {path} is of the same {what} as line {known + 2}. Keep one of them."
            )
