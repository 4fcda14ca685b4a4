"""Foreign entries of a folder: those that labcal did not make; and the removal of its own."""

import stat
from collections.abc import Iterator
from contextlib import suppress
from dataclasses import dataclass
from os import stat_result
from pathlib import Path

from labcal.run.made import MARKS, SCRAP, Made, is_unchanged, made_in, noted_in
from labcal.run.mounts import is_mount

_ANY_WRITE = stat.S_IWUSR | stat.S_IWGRP | stat.S_IWOTH


@dataclass(frozen=True)
class _Entry:
    """One entry of a folder, seen while walking through it."""

    path: Path
    name: str
    """Its path in the folder that is walked through."""
    known: bool
    """True if labcal made it."""
    remark: str = ""
    """The reason why an entry is foreign, in brackets, for messages."""


def foreign_entries(folder: Path) -> list[str]:
    """Return the entries of a folder that labcal did not make, or that were changed since.

    Parameters
    ----------
    folder : Path
        With a mark, or under construction; of one that has neither, everything is foreign.

    Returns
    -------
    list of str
        Paths in the folder, with a remark where that is needed.
    """
    return [entry.name + entry.remark for entry in _entries(folder) if not entry.known]


def remove_made(folder: Path) -> None:
    """Remove what labcal made in a folder, and the folder itself where nothing else is in it.

    What cannot be removed is left, together with the mark, so that labcal recognises the rest later.
    """
    with suppress(OSError):
        for entry in _entries(folder):
            if entry.known and not entry.path.is_dir():
                entry.path.unlink()
            elif entry.known:
                with suppress(OSError):
                    entry.path.rmdir()  # refused where something is left in it
        if not {path.name for path in folder.iterdir()} - {*MARKS}:
            for name in MARKS:
                (folder / name).unlink(missing_ok=True)
            folder.rmdir()


def _entries(folder: Path) -> list[_Entry]:
    """Return all entries of a folder without its marks; the content of an inner folder comes before it."""
    made = made_in(folder) or noted_in(folder)
    return list(_walk(folder, folder, made))


def _walk(root: Path, folder: Path, made: Made) -> Iterator[_Entry]:
    """Walk through a folder below `root`, whose marks are left out."""
    folders = made.all_folders
    for path in sorted(folder.iterdir()):
        name = path.relative_to(root).as_posix()
        status = path.lstat()
        regular = stat.S_ISREG(status.st_mode)
        if regular and folder == root and path.name in MARKS:
            continue
        if regular and path.name.startswith(SCRAP):
            yield _Entry(path, name, known=True)
        elif stat.S_ISLNK(status.st_mode):
            yield _Entry(path, name, known=False, remark=" (a link)")
        elif stat.S_ISDIR(status.st_mode):
            yield from _walk_folder(root, path, made, folders)
        elif not regular or name not in made.files:
            yield _Entry(path, name, known=False)
        else:
            yield _judged(path, name, status, made.files[name])


def _walk_folder(root: Path, path: Path, made: Made, folders: set[str]) -> Iterator[_Entry]:
    """Walk through an inner folder; one that labcal did not make is one entry."""
    name = path.relative_to(root).as_posix()
    if name not in folders or is_mount(path):
        yield _Entry(path, f"{name}/", known=False)
        return
    if name in made.folders:  # it has a mark of its own
        for entry in _entries(path):
            yield _Entry(entry.path, f"{name}/{entry.name}", entry.known, entry.remark)
        marks = (path / mark for mark in MARKS)
        yield from (_Entry(mark, f"{name}/{mark.name}", known=True) for mark in marks if mark.is_file())
    else:
        yield from _walk(root, path, made)
    protected = not path.stat().st_mode & _ANY_WRITE
    yield _Entry(path, f"{name}/", known=not protected, remark=" (write-protected)" if protected else "")


def _judged(path: Path, name: str, status: stat_result, digest: str | None) -> _Entry:
    """Return a file that is listed, judged by its digest, or by its own mark."""
    if not status.st_mode & _ANY_WRITE:
        return _Entry(path, name, known=False, remark=" (write-protected)")
    if not is_unchanged(path, digest):
        return _Entry(path, name, known=False, remark=" (changed since labcal wrote it)")
    return _Entry(path, name, known=True)
