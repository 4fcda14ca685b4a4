"""Numbers in the text files of other systems: exact on the way out, checked on the way in."""

import math
import re
from collections.abc import Sequence
from pathlib import Path

from labcal.errors import InputError
from labcal.wording import shown

_MOST = 1e20
"""Of any number: squares and products of a few of them do not overflow."""
_NUMBER = re.compile(r"[-+]?(\d+\.?\d*|\.\d+)([eE][-+]?\d+)?", re.ASCII)
"""Python also takes ``1_000`` and digits of other scripts for numbers; no other system writes them."""
_MOST_PIXELS = 2**26
"""As many as a picture may have."""


def number_text(value: float) -> str:
    """Return a float so that it reads back exactly, also in YAML 1.1, where an exponent needs a point."""
    text = repr(float(value))
    mantissa, e, exponent = text.partition("e")
    return text if not e or "." in mantissa else f"{mantissa}.0e{exponent}"


def is_number(text: str) -> bool:
    """Tell whether a text is a decimal number, as all systems write it."""
    return _NUMBER.fullmatch(text.strip()) is not None


def finite_number(value: object, what: str, source: Path) -> float:
    """Return a number of a file.

    Raises
    ------
    InputError
        It is no number, or not finite.
    """
    # YAML 1.1 takes 1e-3 for text, and truth values for numbers.
    if isinstance(value, (int, float, str)) and not isinstance(value, bool):
        try:
            number = math.nan if isinstance(value, str) and not is_number(value) else float(value)
        except (ValueError, OverflowError):
            number = math.nan
        if abs(number) <= _MOST:
            return number
    raise InputError(f"{source}: {what} should be a finite number within reason, but is {_shown(value)}.")


def finite_numbers(values: object, counts: Sequence[int], what: str, source: Path) -> tuple[float, ...]:
    """Return a list of numbers of a file.

    Raises
    ------
    InputError
        It is no list, of none of the lengths `counts`, or something in it is no finite number.
    """
    if not isinstance(values, (list, tuple)) or len(values) not in counts:
        lengths = " or ".join(str(count) for count in counts)
        given = f"{len(values)}" if isinstance(values, (list, tuple)) else _shown(values)
        raise InputError(f"{source}: {what} should hold {lengths} numbers, but holds {given}.")
    return tuple(finite_number(value, what, source) for value in values)


def picture_size(values: object, source: Path) -> tuple[int, int]:
    """Return width and height of a file's pictures.

    Raises
    ------
    InputError
        They are no two positive whole numbers, or there would be more pixels than any picture has.
    """
    width, height = finite_numbers(values, (2,), "the size of the pictures", source)
    sound = width == int(width) and height == int(height) and min(width, height) >= 1
    if not sound or width * height > _MOST_PIXELS:
        raise InputError(
            f"{source}: the size of the pictures, {width:g} x {height:g}, is no size of a picture."
        )
    return (int(width), int(height))


def known_size(
    stated: object, given: tuple[int, int] | None, source: Path, of: str = "the pictures"
) -> tuple[int, int]:
    """Return the size of the pictures, px, which a file states or a person does.

    Parameters
    ----------
    stated : object
        What the file states; None for nothing.
    given : (int, int), optional
        What a person states. It may exchange the sides that the file states.
    source : Path
    of : str
        The pictures, for messages.

    Raises
    ------
    InputError
        Nobody states it, both do otherwise, or as of :func:`picture_size`.
    """
    if stated is None:
        if given is None:
            raise InputError(f"{source} does not state how large {of} are. Give it: `size='1280x960'`.")
        return given
    size = picture_size(stated, source)
    if given is not None and not same_sides(given, size):
        raise InputError(f"{source} states a picture size of {size[0]}x{size[1]}. Leave `size` out.")
    return given or size


def same_sides(given: tuple[int, int], stated: tuple[int, int]) -> bool:
    """Tell whether a size that a person gives has the sides that a file states, in either order.

    Many programs take height and width from the shape of an array, so that a person may exchange them.
    """
    return sorted(given) == sorted(stated)


def _shown(value: object) -> str:
    """Return a value for a message, not too much of it."""
    known = isinstance(value, (str, int, float, type(None)))
    return shown(value, 40) if known else f"a {type(value).__name__}"
