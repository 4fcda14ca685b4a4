"""CSV files with a fixed first line."""

import csv
import io
from collections.abc import Iterable, Sequence
from pathlib import Path

from labcal.errors import InputError


def table_text(header: Sequence[str], lines: Iterable[Sequence[object]]) -> str:
    """Return the text of a table; floats are written so that they read back exactly."""
    text = io.StringIO()
    writer = csv.writer(text, lineterminator="\n")
    writer.writerow(header)
    for line in lines:
        writer.writerow([repr(value) if isinstance(value, float) else value for value in line])
    return text.getvalue()


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
    try:
        with path.open(newline="", encoding="utf-8") as handle:
            lines = list(csv.reader(handle))
    except OSError as error:
        raise InputError(f"The {what} {path} cannot be read: {error.strerror or error}.") from error
    except (UnicodeDecodeError, csv.Error) as error:
        raise InputError(f"The {what} {path} cannot be read: {error}.") from error
    if not lines or lines[0] != list(header):
        raise InputError(f"{path} is no table of {what}: its first line should be {','.join(header)}.")
    return lines[1:]


def damaged_line(path: Path, number: int, line: Sequence[str]) -> InputError:
    """Return the error for a line that cannot be understood; `number` counts from 0 after the header."""
    return InputError(f"Line {number + 2} of {path} is damaged: {','.join(line)}")
