"""Names of cameras from how names of pictures and folders call them."""

import re
from collections.abc import Sequence

from labcal.run.names import is_name

_SIDE_NAMES = {"left": "left", "l": "left", "right": "right", "r": "right"}


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
