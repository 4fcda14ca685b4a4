"""Cameras whose folders or names are called so, though the names are built differently: left0, right_0."""

import re
from collections import defaultdict
from collections.abc import Sequence
from pathlib import Path

from labcal.cameras.sides import SIDES, plain_word, words_in
from labcal.correspond.camera_folders import equal_folders
from labcal.correspond.crossed_names import called_sides
from labcal.correspond.group_option import folder_option, group_option
from labcal.correspond.name_patterns import name_parts
from labcal.correspond.name_words import is_camera_word, is_date, is_dated, is_unit
from labcal.correspond.names_alike import common_start
from labcal.correspond.natural_order import in_name_order

_LEAST_PICTURES, _MOST = 3, 64
_CALLED = re.compile(r"(?P<word>[^\W\d_]+)[-_ .]?(?P<number>\d+)(?P<behind>[^\W\d_]*)")


def cameras_apart(images: Sequence[str]) -> tuple[str | None, tuple[str, ...]] | None:
    """Return what distinguishes cameras that are called so, as ``--cameras`` takes it, and a picture of each.

    Every picture has one side, left or right, or the number of one camera, in its folder or in its name.

    Parameters
    ----------
    images : sequence of str
        Paths of all pictures.

    Returns
    -------
    (str or None, tuple of str) or None
        As ``left/*=left,right/*=right``; None if these are no cameras.
    """
    names = name_parts(images)
    paths = [
        [text for kind, text in zip(name.kinds, name.parts, strict=True) if kind == "folder"]
        for name in names
    ]
    for folders in zip(*paths, strict=False):
        groups = _grouped(images, folders)
        if groups is not None and _are_cameras(set(groups)):
            equal = equal_folders(images)
            if equal is not None and len(equal[1]) == len(groups):
                return equal
            return folder_option(groups), tuple(group[0] for group in groups.values())
    if len({name.kinds for name in names}) <= 1:
        return None  # names that are built alike tell it themselves
    stems = [Path(image).stem for image in images]
    for called in (_sides(stems), [_number(stem) for stem in stems]):
        groups = _grouped(images, called)
        if groups is not None:
            option = group_option(list(groups.values()), list(groups))
            return option, tuple(group[0] for group in groups.values())
    return None


def _grouped(images: Sequence[str], called: Sequence[str]) -> dict[str, list[str]] | None:
    """Return the pictures of each camera, in order; None where one has no name, or few pictures."""
    groups: dict[str, list[str]] = defaultdict(list)
    for image, name in zip(images, called, strict=True):
        groups[name].append(image)
    if "" in groups or not 1 < len(groups) <= _MOST or min(map(len, groups.values())) < _LEAST_PICTURES:
        return None
    return {name: groups[name] for name in sorted(groups, key=in_name_order)}


def _are_cameras(folders: set[str]) -> bool:
    """Tell whether folders are called left and right, or cam1, cam2 ..."""
    start = common_start(folders).rstrip("-_ .0")
    return called_sides(folders) or (is_camera_word(start) and not all(map(is_dated, folders)))


def _sides(stems: Sequence[str]) -> list[str]:
    """Return the side in each name, of the language in which every name has one; empty texts if none has."""
    found = [set(words_in(stem)) for stem in stems]
    for pair in SIDES:
        sides = {plain_word(side) for side in pair}
        if all(len(words & sides) == 1 for words in found) and sides <= set().union(*found):
            return [(words & sides).pop() for words in found]
    return [""] * len(stems)


def _number(stem: str) -> str:
    """Return the number that a name gives a camera, with its word; empty where it gives none."""
    numbers = {
        f"{one['word']}{one['number']}"
        for one in _CALLED.finditer(stem)
        if is_camera_word(one["word"])
        and not is_date(one["number"])
        and not is_unit(one["behind"], counted=one["number"] in {"0", "1"})
    }
    return numbers.pop() if len(numbers) == 1 else ""
