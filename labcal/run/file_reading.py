"""Files read whole: regular files of a sensible size, and nothing that waits or never ends."""

import errno
import os
import stat
from pathlib import Path

from labcal.errors import InputError

MOST_OF_A_DESCRIPTION = 2**18
"""Bytes of a YAML file that a person writes; its reader takes seconds for more."""
MOST_OF_A_DOCUMENT = 2**24
"""Bytes of a JSON file."""
MOST_OF_A_TABLE = 2**27
"""Bytes of a CSV file: a million dots."""


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


def read_bytes(path: Path, what: str, most: int) -> bytes:
    """Return what a file holds; see :func:`require_file` for the parameters and errors."""
    require_file(path, what, most)
    try:
        with path.open("rb") as handle:
            data = handle.read(most + 1)
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
    try:
        return read_bytes(path, what, most).decode("utf-8-sig")
    except UnicodeDecodeError as error:
        raise InputError(f"The {what} {path} cannot be read: {error}. Save it as UTF-8.") from error
