"""Paths as they are given: text, or anything that stands for one."""

import os
from pathlib import Path

from labcal.errors import InputError, InputTypeError
from labcal.wording import shown

_MOST_BYTES = 255
"""Of a name of a file or folder: the bound of nearly all file systems."""
AnyPath = str | os.PathLike[str]
"""A path as a public function takes it."""


def as_path(given: AnyPath) -> Path:
    """Return a path as :class:`pathlib.Path`.

    Parameters
    ----------
    given : str or os.PathLike

    Raises
    ------
    InputTypeError
        It is no path: a number, None, bytes, or an open file.
    InputError
        No file can have it: it is empty, a name in it is too long, or it holds a null character.

    Examples
    --------
    >>> as_path("shoots/monday").name
    'monday'
    """
    text = as_text(given)
    if not text:
        raise InputError("The path that is given is empty. Name a file or folder; '.' is the current folder.")
    return given if isinstance(given, Path) else Path(text)


def as_text(given: AnyPath) -> str:
    """Return a path, or a name in place of one, as a text: ``./board`` is a path, ``board`` may be a name.

    Raises
    ------
    InputTypeError
        As of :func:`as_path`.

    Examples
    --------
    >>> as_text(Path("boards") / "mine.yaml")
    'boards/mine.yaml'
    """
    text = os.fspath(given) if isinstance(given, str | os.PathLike) else None
    if not isinstance(text, str):
        raise InputTypeError(
            f"A path is a text or an os.PathLike, but {shown(given)} of type {type(given).__name__} was "
            "given."
        )
    longest = max((len(part.encode(errors="surrogatepass")) for part in Path(text).parts), default=0)
    if "\0" in text or longest > _MOST_BYTES:
        raise InputError(
            f"{shown(text)} cannot be the path of a file: a part of it has more than {_MOST_BYTES} bytes, or "
            "it holds a null character. Give another one."
        )
    return text
