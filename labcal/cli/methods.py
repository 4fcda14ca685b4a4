"""``--method``: methods by name, and ``package.module:Class`` of one's own."""

import sys
from pathlib import Path

from labcal.errors import InputError
from labcal.run.user_code import SEPARATOR


def named_methods(text: str) -> list[str]:
    """Return the methods that an option names, separated by commas.

    Raises
    ------
    InputError
        One is named twice, or one is empty.
    """
    names = [name.strip() for name in text.split(",")]
    if "" in names:
        raise InputError(
            f"--method names nothing between two commas: '{text}'. Give names, as in affine,mlp."
        )
    if len(set(names)) < len(names):
        raise InputError(f"--method names a method twice: {text}. Name each once.")
    if any(SEPARATOR in name for name in names):
        _look_here()
    return names


def own_method(text: str | None) -> str | None:
    """Return the method of one's own that an option names, or None."""
    return None if text is None else named_methods(text)[0]


def _look_here() -> None:
    """Let modules be found in the folder where the command is given, after all that are installed.

    An installed command, unlike ``python -m``, does not look there; last, so that a file there stands in for
    nothing that labcal needs.
    """
    here = str(Path.cwd())
    if here not in sys.path and "" not in sys.path:
        sys.path.append(here)
