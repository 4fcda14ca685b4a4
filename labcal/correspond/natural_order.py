"""The order of names in which cam2 comes before cam10."""

import re
from collections.abc import Sequence

_RUN = re.compile(r"\d+|\D+")


def in_order(parts: Sequence[str]) -> list[tuple[int, str]]:
    """Return a sort key of parts of a name, by which cam2 comes before cam10."""
    return [(len(text.lstrip("0")) if text.isdecimal() else 0, text) for text in parts]


def in_name_order(path: str) -> list[tuple[int, str]]:
    """Return a sort key of paths, by which frame9.png comes before frame10.png."""
    return in_order(_RUN.findall(path))
