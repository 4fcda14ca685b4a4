"""Cameras whose pictures have moments or counters of their own, so that they pair up in their order only."""

import re
from collections import Counter
from collections.abc import Sequence
from pathlib import Path

from labcal.correspond.camera_called import NAMING, camera_called, may_be_device
from labcal.correspond.name_patterns import ANY, NameParts
from labcal.correspond.name_words import is_date
from labcal.correspond.natural_order import in_order

_CAMERAS, _LEAST_PICTURES = range(2, 9), 3
_MOMENTS = 0.6
"""Share of pictures from which on the rest of the name is a moment, which cameras share by chance only."""
_COUNTED = (["0", "1"], ["1", "2"], ["0", "1", "2"], ["1", "2", "3"])
"""Digits at the end of names that count cameras."""


def cameras_in_turn(names: Sequence[NameParts]) -> tuple[int, ...] | None:
    """Return the place of a word or serial number that cameras take in turn; None if there is none.

    Each value is in as many pictures, and in the order of the rest of the names each camera takes one picture
    before any takes its next.

    Parameters
    ----------
    names : sequence of NameParts
        Names that are built alike.
    """
    kinds = names[0].kinds
    for place, kind in enumerate(kinds):
        values = Counter(name.parts[place] for name in names)
        last = place == len(kinds) - 1 and len(min(values, key=len)) == 1
        called = _is_called(kind, values) or (last and sorted(values) in _COUNTED)
        if len(values) not in _CAMERAS or not called:
            continue
        rests = [in_order(name.parts[:place] + name.parts[place + 1 :]) for name in names]
        counts = set(values.values())
        moments = len({tuple(rest) for rest in rests}) > _MOMENTS * len(names)
        if not moments or len(counts) > 1 or min(counts) < _LEAST_PICTURES:
            continue
        order = [  # of moments
            name.parts[place] for _, name in sorted(zip(rests, names, strict=True), key=lambda one: one[0])
        ]
        sets = [order[start : start + len(values)] for start in range(0, len(order), len(values))]
        if all(len(set(one)) == len(values) for one in sets):
            return (place,)
    return None


def _is_called(kind: str, values: Counter[str]) -> bool:
    """Tell whether texts may be what cameras are called: words, folders, or serial numbers, no dates."""
    return may_be_device(kind, values) and (kind in NAMING or not all(map(is_date, values)))


def order_option(names: Sequence[NameParts], places: tuple[int, ...]) -> str | None:
    """Return lists of pictures that pair up in their order, as ``--cameras`` takes them.

    Parameters
    ----------
    names : sequence of NameParts
        Names that are built alike.
    places : tuple of int
        The parts that tell the camera.

    Returns
    -------
    str or None
        As ``left=photos/left_*.png,right=photos/right_*.png``; None where pictures are in several folders, or
        cameras have not equally many.
    """
    folders = {Path(name.image).parent for name in names}
    counts = Counter(tuple(name.parts[place] for place in places) for name in names)
    if len(folders) > 1 or len(set(counts.values())) > 1:
        return None
    constant = [len(set(texts)) == 1 for texts in zip(*(name.parts for name in names), strict=True)]
    suffixes = {Path(name.image).suffix for name in names}
    forms = {}
    for value in sorted(counts, key=in_order):
        fixed = dict(zip(places, value, strict=True))
        texts = [
            fixed.get(place, text if constant[place] else ANY) for place, text in enumerate(names[0].parts)
        ]
        form = re.sub(r"\*+", ANY, "".join(texts)) + (suffixes.copy().pop() if len(suffixes) == 1 else ".*")
        forms[camera_called(value[0])] = str(folders.copy().pop() / form)
    plain = not any(mark in form for form in forms.values() for mark in ",={[?")
    return (
        ",".join(f"{camera}={form}" for camera, form in forms.items())
        if plain and len(forms) == len(counts)
        else None
    )
