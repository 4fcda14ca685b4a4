"""Doubts whether pictures that are taken as of one camera are of one."""

import re
from collections import defaultdict
from collections.abc import Sequence
from itertools import pairwise
from pathlib import Path

from labcal.correspond.camera_folders import equal_folders
from labcal.correspond.group_option import folder_option, group_option
from labcal.correspond.name_patterns import one_camera_pattern
from labcal.correspond.named_cameras import doubted_cameras
from labcal.wording import counted, listed

_LEAST_PICTURES, _CAMERAS, _SHOWN = 3, range(2, 4), 3
_FAR, _ALIKE = 3, 0.75
"""Least gap between rows over the gaps within them, and least share of the longest row in the others."""
_NUMBERS = re.compile(r"\d+")


def doubts(images: Sequence[str]) -> str | None:
    """Return a message where pictures of one camera may be of several; None where nothing says so.

    Names do not tell it, but pictures lie in several folders, have names of two kinds, numbers that are each
    in every view, or equally many numbers in two rows far apart, as two cameras count that were copied into
    one folder.

    Parameters
    ----------
    images : sequence of str
        Paths of all pictures.
    """
    doubt = _crossed(images) or _folders(images) or _kinds(images) or _rows(images)
    if doubt is None:
        return None
    shown, option = doubt
    apart = (
        "list the pictures of each in a text file, a path a line, in the order of the views: "
        "`cameras='left=left.txt,right=right.txt'`"
        if option is None
        else f"distinguish them: `cameras='{option}'`"
    )
    return (
        f"{counted(len(images), 'picture')} are taken as of one camera, but {shown}. If there are several, "
        f"{apart}. If one camera took them all, state it: `cameras='{one_camera_pattern(images)}=camera'`."
    )


def _crossed(images: Sequence[str]) -> tuple[str, str | None] | None:
    """Return numbers each of which is in every view, as 4103_001, 4104_001."""
    found = doubted_cameras(images)
    if found is None:
        return None
    option, values, views = found
    shown = f"each of {counted(views, 'name')} comes with all of the numbers {listed(values, _SHOWN)}"
    return shown, option


def _folders(images: Sequence[str]) -> tuple[str, str | None] | None:
    groups = _grouped(images, [str(Path(image).parent) for image in images])
    large = [folder for folder, inside in groups.items() if len(inside) >= _LEAST_PICTURES]
    named = _numbered(images)
    counts_on = bool(named) and all(two[0] - one[0] == 1 for one, two in pairwise(named))
    if len(large) <= 1 or counts_on:
        return None
    equal = equal_folders(images)
    option = folder_option(groups) if equal is None else equal[0]
    return f"they are in {counted(len(groups), 'folder')} ({listed(large, _SHOWN)})", option


def _kinds(images: Sequence[str]) -> tuple[str, str | None] | None:
    """Return names of two kinds, as IMG_0031.JPG and DSC00771.JPG."""
    groups = _grouped(images, [_NUMBERS.sub("0", Path(image).stem) for image in images])
    large = [Path(inside[0]).name for inside in groups.values() if len(inside) >= _LEAST_PICTURES]
    if len(large) <= 1:
        return None
    return f"their names are of {len(large)} kinds ({listed(large, _SHOWN)})", group_option(
        list(groups.values())
    )


def _grouped(images: Sequence[str], keys: Sequence[str]) -> dict[str, list[str]]:
    groups: dict[str, list[str]] = defaultdict(list)
    for image, key in zip(images, keys, strict=True):
        groups[key].append(image)
    return groups


def _rows(images: Sequence[str]) -> tuple[str, str | None] | None:
    """Return rows of numbers, nearly equally long and further apart than they are long."""
    named = _numbered(images)
    for cameras in _CAMERAS:
        if len(named) <= cameras:
            return None
        steps = sorted(
            ((two[0] - one[0], place) for place, (one, two) in enumerate(pairwise(named), 1)), reverse=True
        )
        apart, within = steps[: cameras - 1], steps[cameras - 1 :]
        ends = sorted([0, *(place for _, place in apart), len(named)])
        rows = [named[start:stop] for start, stop in pairwise(ends)]
        fewest, most = min(map(len, rows)), max(map(len, rows))
        longest = max(row[-1][0] - row[0][0] for row in rows if row)
        far = bool(within) and apart[-1][0] > max(longest, _FAR * within[0][0])
        if far and fewest >= max(_LEAST_PICTURES, _ALIKE * most):
            groups = [[image for _, image in row] for row in rows]
            texts = [f"{Path(row[0]).name} to {Path(row[-1]).name}" for row in groups]
            shown = f"their numbers are in {cameras} rows far apart ({listed(texts, _SHOWN)})"
            return shown, group_option(groups)
    return None


def _numbered(images: Sequence[str]) -> list[tuple[int, str]]:
    """Return the numbers in names, in order, with the pictures; none if names have no one counter."""
    found = [_NUMBERS.findall(Path(image).stem) for image in images]
    if len({len(numbers) for numbers in found}) != 1 or not found[0]:
        return []
    places = [place for place, texts in enumerate(zip(*found, strict=True)) if len(set(texts)) > 1]
    if len(places) != 1:
        return []
    return sorted((int(numbers[places[0]]), image) for numbers, image in zip(found, images, strict=True))
