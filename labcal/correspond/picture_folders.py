"""Pictures in files, folders and lists, as they are given."""

from collections import Counter
from collections.abc import Sequence
from itertools import islice
from pathlib import Path

from labcal.correspond.picture_lists import LIST, listed_pictures
from labcal.errors import InputError
from labcal.paths import AnyPath, as_path
from labcal.shoot.pictures import SUFFIXES
from labcal.wording import listed

_ENDINGS_SHOWN = 8
_FOLDERS_TRIED = 100
_LEVELS = 4
"""Folders within a folder in which pictures are looked for."""


def picture_files(paths: Sequence[str]) -> list[str]:
    """Return pictures one by one; a folder stands for those in it, and a list for those that it names.

    Raises
    ------
    InputError
        A path does not exist, or a list names no pictures.
    """
    found: list[str] = []
    for given in paths:
        path = Path(given)
        if path.is_dir():
            found += [image for folder in picture_folders(path) for image in _pictures_in(folder)]
        elif path.is_file() and path.suffix.lower() == LIST:
            found += listed_pictures(path)
        elif path.is_file():
            found.append(given)
        else:
            raise InputError(f"There is no picture or folder {given}.")
    return found


def endings_seen(paths: Sequence[str]) -> str:
    """Return the endings of the files in folders, the most frequent ones first, for a message."""
    entries = [
        entry
        for given in paths
        if Path(given).is_dir()
        for folder in picture_folders(given)
        for entry in folder.iterdir()
        if entry.is_file()
    ]
    tops = [top for given in paths if Path(given).is_dir() for top in picture_folders(given)]
    below = islice((folder for top in tops for folder in _folders_in([top])), _FOLDERS_TRIED)
    deeper = next((one for one in below if any(map(_pictures_in, picture_folders(one)))), None)
    if deeper is not None:
        return f", but there are in {deeper}. Give that folder"
    endings = Counter(entry.suffix.lower() or "without an ending" for entry in entries)
    if not endings:
        return ": no file is there"
    seen = [f"{count} {ending}" for ending, count in endings.most_common()]
    return f": the files there are {listed(seen, _ENDINGS_SHOWN)}"


def picture_folders(folder: AnyPath) -> list[Path]:
    """Return the folders whose pictures a folder stands for.

    Itself; or those in it where it has no picture; or those in them, as ``cam0/data/0001.png``, where these
    have none either.
    """
    level = [as_path(folder)]
    every = list(level)
    for _ in range(_LEVELS):
        if any(_pictures_in(one) for one in level):
            return level
        level = list(islice((folder for one in level for folder in _folders_in([one])), _FOLDERS_TRIED))
        every += level
    return level if any(_pictures_in(one) for one in level) else every


def _folders_in(folders: Sequence[Path]) -> list[Path]:
    return [entry for one in folders for entry in sorted(one.iterdir()) if entry.is_dir()]


def _pictures_in(folder: Path) -> list[str]:
    return sorted(str(entry) for entry in folder.iterdir() if entry.suffix.lower() in SUFFIXES)
