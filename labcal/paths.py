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
    if isinstance(given, Path):
        return given
    if isinstance(given, str) or (isinstance(given, os.PathLike) and isinstance(os.fspath(given), str)):
        return Path(given)
    raise InputTypeError(
        f"A path is a text or an os.PathLike, but {shown(given)} of type {type(given).__name__} was given."
    )
