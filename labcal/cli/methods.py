"""``--method``: methods by name, and ``package.module:Class`` of one's own."""

import sys
from pathlib import Path
from typing import TYPE_CHECKING

from labcal.errors import InputError
from labcal.run.user_code import SEPARATOR

if TYPE_CHECKING:
    from labcal.estimators.estimator import PointEstimator
    from labcal.estimators.fit_settings import FitSettings


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


def named_estimators(text: str, settings: "FitSettings") -> "list[PointEstimator]":
    """Return the methods that an option names, with the settings that concern them.

    Raises
    ------
    UnknownNameError
        There is no such method or lens.
    InputError
        One is named twice, if under two names, or is none.
    """
    from labcal.pipeline import estimators_of

    estimators = estimators_of(named_methods(text), settings)
    if len({one.method for one in estimators}) < len(estimators):
        raise InputError(f"--method names a method twice: {text}. Name each once.")
    return estimators


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
