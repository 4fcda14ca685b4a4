"""Cells of foreign tables: delimited texts of unknown form, and the numbers in them."""

import csv
import io
from math import isinf
from pathlib import Path

from labcal.correspond.named_pixels_csv import MOST_BYTES
from labcal.errors import InputError
from labcal.run.decimal_words import decimal
from labcal.run.file_reading import read_text
from labcal.wording import clipped, printable

COMMENTS = ("***", "#")
"""Beginnings of lines before the columns' names that are none: of DICe, and of many others."""


def cells_of(path: Path) -> list[tuple[int, list[str]]]:
    """Return the lines of a delimited table with their numbers, from 1, but comments and empty lines.

    The delimiter is the first of comma, semicolon and tab that the first line has; without any, blanks are.

    Raises
    ------
    InputError
        It cannot be read, or holds nothing.
    """
    text = read_text(path, "table", MOST_BYTES)
    kept = [
        (number, line)
        for number, line in enumerate(text.splitlines(), start=1)
        if line.strip() and not line.lstrip().startswith(COMMENTS)
    ]
    if not kept:
        raise InputError(f"{path} holds no table.")
    delimiter = next((one for one in ",;\t" if one in kept[0][1]), None)
    if delimiter is None:
        return [(number, line.split()) for number, line in kept]
    try:
        reader = csv.reader(
            io.StringIO("\n".join(line for _, line in kept)), delimiter=delimiter, skipinitialspace=True
        )
        rows = [[cell.strip() for cell in row] for row in reader]
    except csv.Error as error:
        raise InputError(f"The table {path} cannot be read: {error}.") from error
    if len(rows) != len(kept):
        raise InputError(f"{path} has cells with line ends in them, which no table of pixels has.")
    return [(number, row) for (number, _), row in zip(kept, rows, strict=True)]


def number_in(cell: str, path: Path, line: int) -> float:
    """Return the number in a cell; NaN where it is empty or says so.

    Raises
    ------
    InputError
        It is no number, or not a finite one.
    """
    try:
        value = decimal(cell) if cell else float("nan")
    except ValueError as error:
        given = clipped(printable(cell), 20)
        raise InputError(f"Line {line} of {path} is damaged: '{given}' is no number.") from error
    if isinf(value):
        raise InputError(f"Line {line} of {path} is damaged: '{clipped(cell, 20)}' is no pixel.")
    return value
