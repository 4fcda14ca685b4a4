"""Values of ``--cameras`` for groups of pictures: folders, or how their names begin or end."""

import re
from collections.abc import Iterator, Mapping, Sequence
from fnmatch import fnmatchcase
from pathlib import Path

from labcal.correspond.camera_called import cameras_called
from labcal.correspond.name_patterns import ANY, tells_apart, view_in
from labcal.correspond.names_alike import common_start

_BY_CHANCE = 0.2
"""Share of views that all groups have, up to which their names are equal by chance."""
_SPECIAL = ",={[?*"


def folder_option(groups: Mapping[str, Sequence[str]]) -> str | None:
    """Return patterns of folders, as ``left/*=left,right/*=right``; None where they do not work.

    Parameters
    ----------
    groups : mapping of str to sequence of str
        Pictures by folder.
    """
    called, inside = cameras_called(list(groups)), list(groups.values())
    for form in ("{}/" + ANY, ANY + "/{}/" + ANY):
        option = _option([form.replace("{}", folder) for folder in groups], called, inside)
        if option is not None:
            return option
    return None


def group_option(groups: Sequence[Sequence[str]], called: Sequence[str] | None = None) -> str | None:
    """Return what the names of each group begin or end with, for ``--cameras``; None where nothing works.

    Where names do not give the same views to all groups, and these are equally large, they are lists of
    pictures that pair up in their order.

    Parameters
    ----------
    groups : sequence of sequence of str
        Pictures of each camera.
    called : sequence of str, optional
        What pictures call each camera; where left out, the words and numbers that others have not.
    """
    for patterns in _patterns([[Path(image).stem for image in images] for images in groups]):
        names = cameras_called(_apart(patterns) if called is None else called)
        option = _option(patterns, names, groups)
        if option is not None:
            lists = None if _pair(patterns, groups) else _lists(patterns, names, groups)
            return lists or option
    return None


def _option(patterns: Sequence[str], called: Sequence[str], groups: Sequence[Sequence[str]]) -> str | None:
    """Return patterns with cameras where they tell the groups apart, picture by picture."""
    images = [image for group in groups for image in group]
    fits = all(
        view_in(image, pattern) is not None
        for pattern, group in zip(patterns, groups, strict=True)
        for image in group
    )
    plain = not any(mark in pattern.replace(ANY, "") for pattern in patterns for mark in ",={")
    if not (fits and plain and len(set(patterns)) == len(patterns) and tells_apart(images, patterns)):
        return None
    return ",".join(f"{pattern}={camera}" for pattern, camera in zip(patterns, called, strict=True))


def _apart(patterns: Sequence[str]) -> list[str]:
    """Return of each pattern the words and numbers that others have not: ``FT2KX1`` of ``img_FT2KX1_*``."""
    words = [re.findall(r"[^\W_]+", pattern) for pattern in patterns]
    shared = set.intersection(*map(set, words))
    return ["-".join(word for word in one if word not in shared) for one in words]


def _patterns(stems: Sequence[Sequence[str]]) -> Iterator[list[str]]:
    """Yield patterns for every group: beginnings without and with digits, then endings."""
    starts = [common_start(set(group)) for group in stems]
    ends = [common_start({stem[::-1] for stem in group})[::-1] for group in stems]
    for texts in ([re.sub(r"\d+$", "", start) for start in starts], starts):
        if all(texts):
            yield [text + ANY for text in texts]
    for texts in ([re.sub(r"^\d+", "", end) for end in ends], ends):
        if all(texts):
            yield texts
    if all(map(any, zip(starts, ends, strict=True))):
        yield [start + ANY if start else ANY + end for start, end in zip(starts, ends, strict=True)]


def _pair(patterns: Sequence[str], groups: Sequence[Sequence[str]]) -> bool:
    """Tell whether groups have the same views, and not by chance."""
    views = [
        {view_in(image, pattern) for image in group} for pattern, group in zip(patterns, groups, strict=True)
    ]
    return len(set.intersection(*views)) > _BY_CHANCE * len(set.union(*views))


def _lists(patterns: Sequence[str], called: Sequence[str], groups: Sequence[Sequence[str]]) -> str | None:
    """Return lists of pictures by the form of their names, where all are in one folder and equally many."""
    images = [image for group in groups for image in group]
    folders = {Path(image).parent for image in images}
    if len(folders) > 1 or len(set(map(len, groups))) > 1:
        return None
    folder, forms = folders.pop(), []
    for pattern, group in zip(patterns, groups, strict=True):
        suffixes = {Path(image).suffix for image in group}
        form = (pattern if ANY in pattern else ANY + pattern) + (
            suffixes.pop() if len(suffixes) == 1 else ".*"
        )
        if [image for image in images if fnmatchcase(Path(image).name, form)] != list(group):
            return None
        forms.append(f"{folder}/{form}")
    plain = not any(mark in form.replace(ANY, "") for form in forms for mark in _SPECIAL)
    return ",".join(f"{camera}={form}" for camera, form in zip(called, forms, strict=True)) if plain else None
