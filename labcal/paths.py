"""Paths as they are given: text, or anything that stands for one."""

import os
from pathlib import Path

from labcal.errors import InputTypeError
from labcal.wording import shown

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

    Examples
    --------
    >>> as_path("shoots/monday").name
    'monday'
    """
    return given if isinstance(given, Path) else Path(as_text(given))


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
    if isinstance(text, str):
        return text
    raise InputTypeError(
        f"A path is a text or an os.PathLike, but {shown(given)} of type {type(given).__name__} was given."
    )
