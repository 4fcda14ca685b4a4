"""Cameras by folders whose pictures pair up in their order."""

from collections import defaultdict
from collections.abc import Sequence
from itertools import pairwise
from pathlib import Path

from labcal.correspond.camera_called import cameras_called
from labcal.correspond.name_patterns import name_parts
from labcal.correspond.names_alike import are_series
from labcal.correspond.natural_order import in_order

_MOST_FOLDERS, _LEAST_PICTURES = 8, 3


def camera_folders(images: Sequence[str]) -> tuple[str | None, tuple[str, ...]] | None:
    """Return the folders of cameras, as ``--cameras`` takes them, and a picture of each.

    Folders that hold equally many pictures are taken for those of cameras, unless the pictures of each count
    on from those of the one before, or folders are called days, sets or the like.

    Parameters
    ----------
    images : sequence of str
        Paths of all pictures.

    Returns
    -------
    (str or None, tuple of str) or None
        As ``left=A/,right=B/``, None where paths have commas or the like; None if these are no cameras.
    """
    found = equal_folders(images)
    if found is None or are_series(set(_apart([str(Path(image).parent) for image in found[1]]))):
        return None
    return None if _count_on(_inside(images)) else found


def equal_folders(images: Sequence[str]) -> tuple[str | None, tuple[str, ...]] | None:
    """Return folders that hold equally many pictures, as :func:`camera_folders` does.

    Here the pictures of each may count on from those of the one before, since folders are called so that
    cameras took them.

    Parameters
    ----------
    images : sequence of str
        Paths of all pictures.
    """
    inside = {str(Path(pictures[0]).parent): pictures for pictures in _inside(images)}
    counts = {len(pictures) for pictures in inside.values()}
    if not 1 < len(inside) <= _MOST_FOLDERS or len(counts) > 1 or min(counts) < _LEAST_PICTURES:
        return None
    names = cameras_called(_apart(list(inside)))
    plain = not any(mark in folder for folder in inside for mark in ",=")
    option = ",".join(f"{name}={folder}/" for name, folder in zip(names, inside, strict=True))
    return option if plain else None, tuple(pictures[0] for pictures in inside.values())


def _inside(images: Sequence[str]) -> list[list[str]]:
    """Return the pictures of each folder."""
    inside: dict[str, list[str]] = defaultdict(list)
    for image in images:
        inside[str(Path(image).parent)].append(image)
    return list(inside.values())


def _apart(folders: Sequence[str]) -> list[str]:
    """Return of each path the first folder in which it differs from others; its last where lengths differ."""
    parts = [Path(folder).parts for folder in folders]
    if len({len(one) for one in parts}) > 1:
        return [Path(folder).name for folder in folders]
    place = next(place for place, texts in enumerate(zip(*parts, strict=True)) if len(set(texts)) > 1)
    return [one[place] for one in parts]


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
