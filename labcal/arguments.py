"""Arguments of public functions, checked before work begins.

Each function returns what was given in the form in which it is used, or raises an error that names the
argument between backticks. Arrays are those of :mod:`labcal.arrays`, paths those of :mod:`labcal.paths`.
"""

import os
from collections.abc import Iterable, Mapping
from enum import StrEnum
from math import isfinite
from operator import index
from typing import TypeVar

import numpy as np

from labcal.bounds import MOST_NUMBER
from labcal.errors import InputError, InputTypeError, UnknownNameError
from labcal.wording import shown

T = TypeVar("T")
Choice = TypeVar("Choice", bound=StrEnum)


def object_of(given: object, kind: type[T], name: str) -> T:
    """Return an argument that is an object of a class.

    Parameters
    ----------
    given : object
    kind : type
        The class.
    name : str
        Of the argument, for messages.

    Raises
    ------
    InputTypeError
        It is an object of another class.

    Examples
    --------
    >>> object_of("left", str, "camera")
    'left'
    """
    if isinstance(given, kind):
        return given
    raise wrong_type(given, f"an object of the class {kind.__name__}", name)


def settings_of(given: object, kind: type[T]) -> T:
    """Return the settings that are given, or those that hold where none are.

    Raises
    ------
    InputTypeError
        They are of another class.

    Examples
    --------
    >>> from labcal.pipeline import RenderSettings
    >>> settings_of(None, RenderSettings).seed
    0
    """
    if given is None:
        return kind()
    if isinstance(given, kind):
        return given
    raise wrong_type(given, f"{kind.__name__}(...) or left out", "settings")


def whole_number(given: object, name: str, least: int) -> int:
    """Return an argument that is a whole number, also one of NumPy's.

    Raises
    ------
    InputTypeError
        It is something else; a truth value counts as such.
    InputError
        It is below `least`, or above `MOST_NUMBER`.

    Examples
    --------
    >>> whole_number(np.int64(3), "views", 1)
    3
    """
    if isinstance(given, bool | np.bool_) or not hasattr(given, "__index__"):
        raise wrong_type(given, "a whole number", name)
    number = index(given)
    if number < least:
        raise InputError(f"`{name}` must be at least {least}, but {shown(number)} was given.")
    if number > MOST_NUMBER:
        bits = number.bit_length()
        raise InputError(f"`{name}` must be at most {MOST_NUMBER}, but a number of {bits} bits was given.")
    return number


def any_number(given: object, name: str, described: str = "a number") -> float:
    """Return an argument that is a number, also one of NumPy's; it may be infinite, or NaN.

    Raises
    ------
    InputTypeError
        It is something else; a truth value and a text count as such.

    Examples
    --------
    >>> any_number(np.float32(0.5), "share")
    0.5
    """
    if isinstance(given, bool | np.bool_) or not hasattr(given, "__float__"):
        raise wrong_type(given, described, name)
    return float(given)


def positive_number(given: object, name: str, unit: str) -> float:
    """Return an argument that is a positive number in a unit, for messages.

    Raises
    ------
    InputTypeError
        It is no number; a truth value counts as none.
    InputError
        It is not positive, or not finite.

    Examples
    --------
    >>> positive_number(1, "pixel_sigma_px", "px")
    1.0
    """
    number = any_number(given, name, f"a number of {unit}")
    if not (isfinite(number) and number > 0.0):
        raise InputError(f"`{name}` must be a positive number of {unit}, but {shown(number)} was given.")
    return number


def real_number(given: object, name: str, ends: tuple[float, float]) -> float:
    """Return an argument that is a number within its ends, also one of NumPy's.

    Raises
    ------
    InputTypeError
        It is something else; a truth value and a text count as such.
    InputError
        It is beyond its ends, or not finite.

    Examples
    --------
    >>> real_number(np.float32(0.5), "share", (0.0, 1.0))
    0.5
    """
    value = any_number(given, name)
    if not ends[0] <= value <= ends[1]:  # of NaN, too
        between = f"from {ends[0]:g} to {ends[1]:g}"
        raise InputError(f"`{name}` must be a number {between}, but {shown(given)} was given.")
    return value


def truth_value(given: object, name: str) -> bool:
    """Return an argument that is true or false: a text such as ``"no"`` would count as true.

    Raises
    ------
    InputTypeError
        It is something else.
    """
    if isinstance(given, bool | np.bool_):
        return bool(given)
    raise wrong_type(given, "True or False", name)


def one_text(given: object, name: str) -> str:
    """Return an argument that is a text.

    Raises
    ------
    InputTypeError
        It is something else.
    """
    if isinstance(given, str):
        return given
    raise wrong_type(given, "a text", name)


def texts(given: object, name: str) -> tuple[str, ...]:
    """Return an argument that is a sequence of texts; a text by itself is one of them, not its letters.

    Raises
    ------
    InputTypeError
        It is something else.

    Examples
    --------
    >>> texts("noise=off", "overrides")
    ('noise=off',)
    """
    if isinstance(given, str):
        return (given,)
    if isinstance(given, Iterable) and not isinstance(given, bytes | Mapping):
        every = tuple(given)
        if all(isinstance(one, str) for one in every):
            return tuple(str(one) for one in every)
    raise wrong_type(given, "a sequence of texts", name)


def path_texts(given: object, name: str) -> tuple[str, ...]:
    """Return an argument that is a sequence of paths, or one, as texts.

    Raises
    ------
    InputTypeError
        It is something else.

    Examples
    --------
    >>> from pathlib import Path
    >>> path_texts([Path("shoots") / "monday", "friday"], "detections")
    ('shoots/monday', 'friday')
    """
    every = [given] if isinstance(given, str | os.PathLike) else given
    if isinstance(every, Iterable) and not isinstance(every, bytes | Mapping):
        found = tuple(os.fspath(one) if isinstance(one, os.PathLike) else one for one in every)
        if all(isinstance(one, str) for one in found):
            return tuple(map(str, found))
    raise wrong_type(given, "a sequence of paths", name)


def choice_of(given: object, kind: type[Choice], name: str) -> Choice:
    """Return an argument that is one of a few words, by itself or by its text.

    Raises
    ------
    UnknownNameError
        It is none of them; the nearest one is offered.
    InputTypeError
        It is no text.

    Examples
    --------
    >>> from labcal.shoot.manifest import Role
    >>> choice_of("test", Role, "role")
    <Role.TEST: 'test'>
    """
    words = [word.value for word in kind]
    text = one_text(given, name)
    if text not in words:
        raise UnknownNameError(name, text, words)
    return kind(text)


def one_named(known: Mapping[str, T], kind: str, name: str) -> T:
    """Return the one of several that has a name.

    Parameters
    ----------
    known : mapping
        By name.
    kind : str
        What they are, for the message.
    name : str

    Raises
    ------
    UnknownNameError
        There is none of that name; the nearest one is offered.

    Examples
    --------
    >>> one_named({"brown": 1, "water": 2}, "family", "water")
    2
    """
    if name not in known:
        raise UnknownNameError(kind, name, known)
    return known[name]


def set_checked(holder: object, values: Mapping[str, object]) -> None:
    """Set attributes of a frozen dataclass to what its checks returned, within ``__post_init__``."""
    for name, value in values.items():
        object.__setattr__(holder, name, value)


def wrong_type(given: object, expected: str, name: str) -> InputTypeError:
    """Return the error for an argument of a wrong type."""
    return InputTypeError(
        f"`{name}` must be {expected}, but {shown(given)} of type {type(given).__name__} was given."
    )
