"""Doubts whether pictures that are taken as of one camera are of one."""

import re
from collections import Counter, defaultdict
from collections.abc import Sequence
from itertools import pairwise
from pathlib import Path

from labcal.correspond.camera_folders import equal_folders
from labcal.correspond.name_patterns import ANY
from labcal.wording import counted, listed

_LEAST_PICTURES, _CAMERAS, _SHOWN = 3, range(2, 4), 3
_FAR, _ALIKE = 3, 0.75
"""Least gap between rows over the gaps within them, and least share of the longest row in the others."""
_NUMBERS = re.compile(r"\d+")


def doubts(images: Sequence[str]) -> str | None:
    """Return a message where pictures of one camera may be of several; None where nothing says so.

    Names do not tell it, but pictures lie in several folders, have names of two kinds, or equally many
    numbers in two rows far apart, as two cameras count that were copied into one folder.

    Parameters
    ----------
    images : sequence of str
        Paths of all pictures.
    """
    shown = _folders(images) or _kinds(images) or _rows(images)
    if shown is None:
        return None
    folders = equal_folders(images)
    option = "left=A/,right=B/" if folders is None or folders[0] is None else folders[0]
    return (
        f"{counted(len(images), 'picture')} are taken as of one camera, but {shown}. If there are several, "
        f"give a folder or a list for each: `cameras='{option}'`. "
        f"If one camera took them all, state it: `cameras='{ANY}=camera'`."
    )


def _folders(images: Sequence[str]) -> str | None:
    found = Counter(str(Path(image).parent) for image in images)
    large = [folder for folder, count in found.items() if count >= _LEAST_PICTURES]
    named = _numbered(images)
    counts_on = bool(named) and all(two[0] - one[0] == 1 for one, two in pairwise(named))
    if len(large) <= 1 or counts_on:
        return None
    return f"they are in {counted(len(found), 'folder')} ({listed(large, _SHOWN)})"


def _kinds(images: Sequence[str]) -> str | None:
    """Return names of two kinds, as IMG_0031.JPG and DSC00771.JPG."""
    kinds: dict[str, list[str]] = defaultdict(list)
    for image in images:
        kinds[_NUMBERS.sub("0", Path(image).stem)].append(Path(image).name)
    large = [names[0] for names in kinds.values() if len(names) >= _LEAST_PICTURES]
    return f"their names are of {len(large)} kinds ({listed(large, _SHOWN)})" if len(large) > 1 else None


def _rows(images: Sequence[str]) -> str | None:
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
            texts = [f"{row[0][1]} to {row[-1][1]}" for row in rows]
            return f"their numbers are in {cameras} rows far apart ({listed(texts, _SHOWN)})"
    return None


def _numbered(images: Sequence[str]) -> list[tuple[int, str]]:
    """Return the numbers in names, in order, with the names; none if names have no one counter."""
    found = [_NUMBERS.findall(Path(image).stem) for image in images]
    if len({len(numbers) for numbers in found}) != 1 or not found[0]:
        return []
    places = [place for place, texts in enumerate(zip(*found, strict=True)) if len(set(texts)) > 1]
    if len(places) != 1:
        return []
    return sorted(
        (int(numbers[places[0]]), Path(image).name) for numbers, image in zip(found, images, strict=True)
    )
