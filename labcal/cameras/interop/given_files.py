"""Files of cameras that paths stand for, and the one of COLMAP's two forms that a folder is read by."""

from collections.abc import Collection, Sequence
from itertools import combinations
from pathlib import Path

import numpy as np

from labcal.cameras.interop.exchange import NOTHING_GIVEN, Home, ReadRig, RigFormat, SourceText
from labcal.cameras.interop.registry import READ
from labcal.cameras.rig import Rig
from labcal.cameras.sides import left_first
from labcal.errors import InputError

_MOST_FILES = 100
_LEVELS = 2
"""Folders within a folder that messages speak of."""
_SAME = 1e-9


def given_files(paths: Sequence[Path], wanted: RigFormat | None) -> list[Path]:
    """Return files, with folders replaced by the files in them that end as the formats do.

    Raises
    ------
    InputError
        There is none, or more than cameras of any rig.
    """
    formats = READ.values() if wanted is None else [wanted]
    endings = {suffix for one in formats for suffix in one.suffixes}
    files: list[Path] = []
    for path in paths:
        files += _inside(path, endings) if path.is_dir() else [path]
    if not files:
        below = [folder for path in paths for folder in _folders_below(path) if _inside(folder, endings)]
        mend = f" Give {below[0]}, where there are some." if below else ""
        raise InputError(f"There is no file of any format in {', '.join(map(str, paths))}.{mend}")
    if len(files) > _MOST_FILES:
        raise InputError(
            f"These are {len(files)} files, more than cameras of any rig. Name those of the rig."
        )
    return files


def _inside(folder: Path, endings: Collection[str]) -> list[Path]:
    """Return the files in a folder by name, but that of the left camera before that of the right one."""
    found = sorted(entry for entry in folder.iterdir() if entry.suffix.lower() in endings)
    for one, two in combinations(range(len(found) if len(found) <= _MOST_FILES else 0), 2):
        if left_first([found[one].stem, found[two].stem]) == [found[two].stem, found[one].stem]:
            found[one], found[two] = found[two], found[one]
    return found


def _folders_below(path: Path) -> list[Path]:
    """Return the folders in a folder, those of its first level first."""
    level, every = [path], []
    for _ in range(_LEVELS):
        level = [entry for one in level for entry in sorted(one.iterdir()) if entry.is_dir()][:_MOST_FILES]
        every += level
    return every


def one_format(kinds: Sequence[RigFormat], sources: Sequence[SourceText]) -> tuple[RigFormat, str | None]:
    """Return the format of files; a folder may hold one model of COLMAP as text and in binary form.

    Returns
    -------
    RigFormat
    str or None
        A note where there were both.

    Raises
    ------
    InputError
        They are of several formats, or both forms of COLMAP's model are there and differ.
    """
    if len(kinds) == 1:
        return kinds[0], None
    names = [one.name for one in kinds]
    if any(one.home is not Home.FOLDER for one in kinds):
        raise InputError(
            f"These files are of several formats: {', '.join(names)}. Name one: `from_format='FORMAT'`."
        )
    newest = max(
        kinds,
        key=lambda one: max(_changed(source) for source in sources if source.path.suffix in one.suffixes),
    )
    read = [_read(one, sources) for one in kinds]
    folder = sources[0].path.parent
    if not all(one is not None and read[0] is not None and _alike(one.rig, read[0].rig) for one in read):
        raise InputError(
            f"{folder} holds a model as text and in binary form, and they differ. The files of "
            f"'{newest.name}' are newer. Name one: `from_format='{newest.name}'`."
        )
    return newest, f"{folder} holds the same cameras as text and in binary form: '{newest.name}' is read."


def _changed(source: SourceText) -> float:
    return source.path.stat().st_mtime


def _read(one: RigFormat, sources: Sequence[SourceText]) -> ReadRig | None:
    """Return the rig of a form; None where it cannot be read."""
    try:
        return one.read(sources, NOTHING_GIVEN)
    except InputError:
        return None


def _alike(first: Rig, second: Rig) -> bool:
    """Tell whether two rigs are of the same cameras, but for rounding."""
    if list(first.cameras) != list(second.cameras):
        return False
    pairs = zip(first.cameras.values(), second.cameras.values(), strict=True)
    return all(
        (a.lens, a.size) == (b.lens, b.size)
        and np.allclose(a.K, b.K, rtol=_SAME, atol=0.0)
        and np.allclose(a.dist, b.dist, rtol=_SAME, atol=0.0)
        and np.allclose(a.T_cam_world, b.T_cam_world, rtol=_SAME, atol=_SAME)
        for a, b in pairs
    )
