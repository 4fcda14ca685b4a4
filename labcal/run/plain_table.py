"""Tables without quotation marks, cut into columns many lines at a time.

The reader of CSV files looks at every line by itself, and knows quotation marks and where a line is damaged.
Tables of millions of lines are plain, as programs write them, and take a quarter of that time here. Whatever
is not plain, and whatever is damaged, is left to that reader.
"""

import codecs
from collections.abc import Iterator, Sequence

import numpy as np

_MARKS = (b'"', b"'", b"\r", b"\0")
"""Bytes of tables that are not plain: cells in quotation marks, texts marked as such, other ends of lines."""
_PIECE = 2**16
"""Bytes that are cut at a time: about a thousand lines."""


def plain_columns(
    header: Sequence[str], data: bytes, most_lines: int, longest: int
) -> Iterator[list[list[str]]] | None:
    """Return the columns of a plain table, some lines at a time; None if it is not plain, or damaged.

    Parameters
    ----------
    header : sequence of str
        What the first line must be.
    data : bytes
        The file.
    most_lines : int
        After the header.
    longest : int
        Bytes of a line.
    """
    first = len(codecs.BOM_UTF8) if data.startswith(codecs.BOM_UTF8) else 0
    title = ",".join(header).encode() + b"\n"
    if not data.startswith(title, first) or any(mark in data for mark in _MARKS):
        return None
    first += len(title)
    lines = 0
    for piece in _pieces(data, first):
        found = _lines(piece, len(header), longest)
        if found is None:
            return None
        lines += found
    if lines > most_lines or not _is_text(data):
        return None
    return _columns(data, first, len(header))


def _columns(data: bytes, first: int, width: int) -> Iterator[list[list[str]]]:
    for piece in _pieces(data, first):
        cells = piece.decode().removesuffix("\n").replace("\n", ",").split(",")
        yield [cells[column::width] for column in range(width)]


def _pieces(data: bytes, first: int) -> Iterator[bytes]:
    """Yield whole lines, some at a time."""
    while first < len(data):
        end = data.rfind(b"\n", first, first + _PIECE) + 1
        if end <= first:  # a line that is longer than a piece, or the last one
            end = (data.find(b"\n", first) + 1) or len(data)
        yield data[first:end]
        first = end


def _lines(piece: bytes, width: int, longest: int) -> int | None:
    """Return the number of lines; None if one of them has not `width` cells, or is too long."""
    letters = np.frombuffer(piece if piece.endswith(b"\n") else piece + b"\n", dtype=np.uint8)
    ends = np.flatnonzero(letters == ord("\n"))
    marks = letters[(letters == ord(",")) | (letters == ord("\n"))]
    if len(marks) != width * len(ends) or not (marks[width - 1 :: width] == ord("\n")).all():
        return None
    return len(ends) if np.diff(ends, prepend=-1).max() <= longest else None


def _is_text(data: bytes) -> bool:
    if data.isascii():
        return True
    try:
        data.decode()
    except UnicodeDecodeError:
        return False
    return True
