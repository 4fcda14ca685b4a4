"""CSV files with a fixed first line."""

import csv
import io
import re
from collections.abc import Iterable, Sequence
from pathlib import Path

from labcal.errors import InputError
from labcal.run.file_reading import MOST_OF_A_TABLE, read_text
from labcal.wording import clipped

_FORMULA = re.compile(r"'*[=+\-@\t\r]")
"""How a text begins that a spreadsheet would take for a formula, after any marks that it is a text."""
_MOST_IN_A_LINE = 200


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
        The file cannot be read, or has other columns.
    """
    text = read_text(path, what, MOST_OF_A_TABLE)
    try:
        # Line ends as they are: a cell between quotation marks may hold them.
        reader = csv.reader(io.StringIO(text, newline=""), strict=True)
        lines = [[_value(cell) if cell.startswith("'") else cell for cell in line] for line in reader]
    except csv.Error as error:
        raise InputError(f"The {what} {path} cannot be read: {error}.") from error
    if not lines or lines[0] != list(header):
        raise InputError(f"{path} is no table of {what}: its first line should be {','.join(header)}.")
    return lines[1:]


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
