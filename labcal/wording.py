"""Texts of unknown length and content as parts of a message: short, and without what commands a terminal."""

import re
import sys
from collections.abc import Iterable, Sequence
from itertools import islice

MOST_LETTERS = 2000
"""Of one message. What a file holds may be repeated in it, and a file may hold anything."""
_MOST_OF_A_VALUE = 80
_MOST_NAMES = 12
_TAIL = 400

_UNPRINTABLE = re.compile(
    "[\x00-\x08\x0b-\x1f\x7f-\x9f"  # C0 but tab and line feed, DEL and C1: ESC and CSI are among them
    "\u061c\u200e\u200f\u2028\u2029\u202a-\u202e\u2066-\u2069"  # line separators, and turns of direction
    "\ud800-\udfff]"  # what stands for bytes of a file's name that are no UTF-8
)


def printable(text: str) -> str:
    r"""Return a text with every control character written out, as in ``\x1b``; line feeds and tabs stay.

    Control characters move a terminal's cursor, colour or hide what follows, or turn the direction of
    writing, so that a name may pass for another, or for a message of labcal.
    """
    return _UNPRINTABLE.sub(_written_out, text)


def json_escaped(text: str) -> str:
    r"""Return a JSON text with the same characters as JSON writes them, ``\u009b``: it says the same."""
    return _UNPRINTABLE.sub(lambda found: f"\\u{ord(found[0]):04x}", text)


def has_control(text: str) -> bool:
    """Tell whether a text has what :func:`printable` writes out, a line feed or a tab."""
    return _UNPRINTABLE.search(text) is not None or "\n" in text or "\t" in text


def _written_out(found: re.Match[str]) -> str:
    code = ord(found[0])
    return f"\\x{code:02x}" if code < 0x100 else f"\\u{code:04x}"  # noqa: PLR2004 -- two digits


def shortened(text: str, most: int = MOST_LETTERS) -> str:
    """Return a text of at most about `most` characters: its beginning, and its end, which says what to do."""
    if len(text) <= most:
        return text
    tail = min(_TAIL, most // 4)
    left_out = len(text) - most
    return f"{text[: most - tail]}... [{left_out} characters left out] ...{text[-tail:]}"


def shown(value: object, most: int = _MOST_OF_A_VALUE) -> str:
    """Return a value of a file for a message, not too much of it."""
    if isinstance(value, int) and value.bit_length() > sys.int_info.str_digits_check_threshold:
        return f"a whole number of some {int(value.bit_length() * 0.30103)} digits"
    if isinstance(value, dict | list | tuple | set):
        return f"a {type(value).__name__} of {len(value)}"
    text = repr(value[: 2 * most] if isinstance(value, str | bytes) else value)
    return text if len(text) <= most else f"{text[:most]}..."


def clipped(text: str, most: int = _MOST_OF_A_VALUE) -> str:
    """Return the beginning of a text, where it stands between quotation marks of the message."""
    return text if len(text) <= most else f"{text[:most]}..."


def listed(names: Sequence[str] | Iterable[str], most: int = _MOST_NAMES) -> str:
    """Return names for a message: the first ones, and how many more there are."""
    every = list(names)
    first = ", ".join(clipped(name) for name in islice(every, most))
    return first if len(every) <= most else f"{first} and {len(every) - most} more"


def counted(number: int, noun: str, plural: str | None = None) -> str:
    """Return a number with its noun, as in ``1 view`` and ``2 views``."""
    return f"{number} {noun if number == 1 else plural or noun + 's'}"
