"""Cameras by folders whose pictures pair up in their order, and what a camera is called."""

import re
from collections import defaultdict
from collections.abc import Sequence
from itertools import pairwise
from pathlib import Path

from labcal.correspond.name_patterns import name_parts
from labcal.run.names import is_name

_SIDE_NAMES = {"left": "left", "l": "left", "right": "right", "r": "right"}
_MOST_FOLDERS, _LEAST_PICTURES = 8, 3


def camera_folders(images: Sequence[str]) -> tuple[str | None, tuple[str, ...]] | None:
    """Return the folders of cameras, as ``--cameras`` takes them, and a picture of each.

    Folders that hold equally many pictures are taken for those of cameras, unless the pictures of each count
    on from those of the one before.

    Parameters
    ----------
    images : sequence of str
        Paths of all pictures.

    Returns
    -------
    (str or None, tuple of str) or None
        As ``left=A/,right=B/``, None where paths have commas or the like; None if these are no cameras.
    """
    inside: dict[str, list[str]] = defaultdict(list)
    for image in images:
        inside[str(Path(image).parent)].append(image)
    counts = {len(pictures) for pictures in inside.values()}
    if not 1 < len(inside) <= _MOST_FOLDERS or len(counts) > 1 or min(counts) < _LEAST_PICTURES:
        return None
    if _count_on(list(inside.values())):
        return None
    names = [camera_called(Path(folder).name) for folder in inside]
    plain = len(set(names)) == len(names) and not any(mark in folder for folder in inside for mark in ",=")
    option = ",".join(f"{name}={folder}/" for name, folder in zip(names, inside, strict=True))
    return option if plain else None, tuple(pictures[0] for pictures in inside.values())


def _count_on(folders: Sequence[Sequence[str]]) -> bool:
    """Tell whether names in folders are built alike and each folder's come behind those of another."""
    found = [name_parts([Path(image).name for image in images]) for images in folders]
    built = {
        tuple(text for kind, text in zip(one.kinds, one.parts, strict=True) if kind == "word")
        for images in found
        for one in images
    }
    numbers = sorted(sorted(tuple(in_order(one.parts)) for one in images) for images in found)
    return len(built) == 1 and all(before[-1] < after[0] for before, after in pairwise(numbers))


def in_order(parts: tuple[str, ...]) -> list[tuple[int, str]]:
    """Return a sort key of parts of a name, by which cam2 comes before cam10."""
    return [(len(text.lstrip("0")) if text.isdecimal() else 0, text) for text in parts]


def camera_called(text: str) -> str:
    """Return the name of a camera from how the pictures call it."""
    word = re.sub(r"[^A-Za-z0-9]+", "-", text).strip("-")
    word = _SIDE_NAMES.get(word.casefold(), word)
    return f"cam{word}" if word.isdecimal() or not is_name(word) else word
