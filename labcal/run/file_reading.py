"""Reading of whole files: regular files of a reasonable size, no pipes or devices."""

import codecs
import errno
import os
import re
import stat
from pathlib import Path

from labcal.errors import InputError

MOST_OF_A_DESCRIPTION = 2**18
"""Bytes of a YAML file that a person writes; its reader takes seconds for more."""
MOST_OF_A_DOCUMENT = 2**24
"""Bytes of a JSON file."""
MOST_OF_A_TABLE = 2**27
"""Bytes of a CSV file: a million dots."""

_PIECE = 2**20
_FIRST_LINE = 256
"""Bytes read at a time beyond the size that a file states: it may be growing, or state none."""
_BEGINNING = 1024
_BEGINNINGS = {
    "a model that 'labcal fit' wrote": re.compile(rb'.{7}\0\{\s*"__metadata__"', re.DOTALL),
    "a PNG picture": re.compile(rb"\x89PNG\r\n"),
    "a JPEG picture": re.compile(rb"\xff\xd8\xff"),
    "a TIFF picture": re.compile(rb"II\*\0|MM\0\*"),
    "an OpenEXR picture": re.compile(rb"\x76\x2f\x31\x01"),
    "a PDF document": re.compile(rb"%PDF-"),
    "a ZIP archive (or a spreadsheet, which programs save as CSV, too)": re.compile(rb"PK\x03\x04"),
    "compressed with gzip": re.compile(rb"\x1f\x8b"),
}
"""First bytes of files that are no text in UTF-8, by their kind, for messages."""


def require_file(path: Path, what: str, most: int) -> None:
    """Raise unless a path is a regular file of at most so many bytes, which can be opened.

    Parameters
    ----------
    path : Path
    what : str
        What the file is, for messages: ``"rig"``.
    most : int
        Bytes.

    Raises
    ------
    InputError
        There is no such file, it may not be read, is a folder, a pipe or a device, or is too large.
    """
    try:
        status = path.stat()
        if not stat.S_ISREG(status.st_mode):
            folder = f"{os.strerror(errno.EISDIR)}, so " if stat.S_ISDIR(status.st_mode) else ""
            raise InputError(f"The {what} {path} cannot be read: {folder}it is no file.")
        if status.st_size > most:
            raise InputError(
                f"The {what} {path} is not read: it has {status.st_size} bytes, more than {most} bytes."
            )
        with path.open("rb"):
            pass
    except OSError as error:
        raise InputError(f"The {what} {path} cannot be read: {error.strerror or error}.") from error
    except ValueError as error:  # a name that no file can have
        if isinstance(error, InputError):
            raise
        raise InputError(f"The {what} cannot be read: its name is none of a file ({error}).") from error


def first_line(path: Path) -> bytes:
    """Return the beginning of a file's first line, which shows its kind; nothing of what is no file."""
    if not path.is_file():  # a pipe would wait for ever
        return b""
    try:
        with path.open("rb") as file:
            return file.readline(_FIRST_LINE).removeprefix(codecs.BOM_UTF8).strip()
    except OSError:
        return b""


def read_bytes(path: Path, what: str, most: int) -> bytes:
    """Return the bytes of a file; see :func:`require_file` for the parameters and errors."""
    require_file(path, what, most)
    try:
        with path.open("rb") as handle:
            data = handle.read(os.fstat(handle.fileno()).st_size)  # what is asked for is set aside at once
            while len(data) <= most and (more := handle.read(_PIECE)):
                data += more
    except OSError as error:
        raise InputError(f"The {what} {path} cannot be read: {error.strerror or error}.") from error
    if len(data) > most:  # a file that says it is empty may go on for ever
        raise InputError(f"The {what} {path} is not read: it has more than {most} bytes.")
    return data


def read_text(path: Path, what: str, most: int) -> str:
    """Return the text that a file holds, in UTF-8, without a byte order mark.

    Raises
    ------
    InputError
        As of :func:`require_file`, or it is no such text.
    """
    data = read_bytes(path, what, most)
    try:
        return data.decode("utf-8-sig")
    except UnicodeDecodeError as error:
        raise no_text(what, path, data) from error


def no_text(what: str, path: Path, data: bytes) -> InputError:
    """Return the error for a file that should hold text in UTF-8 and does not, with what it holds instead."""
    if data[:2] in {codecs.BOM_UTF16_LE, codecs.BOM_UTF16_BE}:
        return InputError(f"The {what} {path} cannot be read: it is a text in UTF-16. Save it as UTF-8.")
    kind = next((kind for kind, begins in _BEGINNINGS.items() if begins.match(data)), None)
    if kind is None:
        begins = data[:_BEGINNING]
        if b"\0" not in begins and not any(byte < 9 for byte in begins):  # noqa: PLR2004 -- below the tab
            return InputError(
                f"The {what} {path} cannot be read: it is a text, but not in UTF-8. Save it as UTF-8."
            )
        kind = "a binary file"
    return InputError(f"The {what} {path} cannot be read: it is {kind}, not a text. Give another file.")
