"""Names of cameras from how names of pictures and folders call them."""

import re
from collections.abc import Iterable, Sequence

from labcal.run.names import is_name

NAMING = ("folder", "word", "serial")
"""Parts of names that may be what a camera is called, whatever they are."""
SERIAL_DIGITS = 5
"""Of a number, from which on it may be that of a device."""
_SIDE_NAMES = {"left": "left", "l": "left", "right": "right", "r": "right"}


def may_be_device(kind: str, texts: Iterable[str]) -> bool:
    """Tell whether parts of a kind may be what cameras are called: words, folders, or serial numbers."""
    return kind in NAMING or (kind == "number" and min(map(len, texts)) >= SERIAL_DIGITS)


def camera_called(text: str) -> str:
    """Return the name of a camera from how the pictures call it."""
    word = re.sub(r"[^A-Za-z0-9]+", "-", text).strip("-")
    word = _SIDE_NAMES.get(word.casefold(), word)
    return f"cam{word}" if word.isdecimal() or not is_name(word) else word


def cameras_called(texts: Sequence[str]) -> list[str]:
    """Return a name for each camera; ``cam1``, ``cam2`` ... where texts give no names, or the same ones."""
    names = [camera_called(text) for text in texts]
    alike = len({name.casefold() for name in names}) < len(names) or "cam" in names
    return [f"cam{number}" for number in range(1, len(names) + 1)] if alike else names
