"""Folders that are kept beside their place while others take it, until these are there."""

import os
from pathlib import Path

from labcal.run.durable import flush_file
from labcal.run.foreign import foreign_entries, remove_made
from labcal.run.lock import locked
from labcal.run.made import ASIDE, COMMAND, command_in, made_in
from labcal.run.standing import old_of, working_of


def settle(path: Path) -> None:
    """Bring to its end what a run was killed in that was replacing `path`.

    Where the new folder is not in its place, the old one is put back; where it is, the old one is removed.
    Nothing is done unless labcal moved the old one there, as its mark says, and nothing else is in it; nor
    while another process is at work.
    """
    for home in (working_of(path), path):
        if command_in(home) is not None:
            with locked(home / COMMAND) as free:
                if not free:
                    return
    old = old_of(path)
    if not os.path.lexists(old):
        _remove_aside(path)  # killed before the old one was moved, or after it was moved back
        return
    if old.is_symlink() or not old.is_dir() or foreign_entries(old):
        return
    if not os.path.lexists(path):
        if _is_aside(old, path):
            put_back(old, path)
        return
    replaced = command_in(path) is not None and made_in(path) is not None
    if replaced and (_is_aside(old, path) or not any(old.iterdir())):  # it may have been about to be removed
        remove_made(old)


def mark_aside(folder: Path) -> None:
    """Mark a folder as one that is about to be moved aside; its name in the mark is the one to go back to."""
    mark = folder / ASIDE
    mark.write_text(folder.name, encoding="utf-8", errors="surrogateescape")
    flush_file(mark)


def _is_aside(folder: Path, path: Path) -> bool:
    """Return whether a folder has the mark that it got at `path`."""
    mark = folder / ASIDE
    if folder.is_symlink() or mark.is_symlink() or not mark.is_file():
        return False
    return mark.read_text(encoding="utf-8", errors="surrogateescape") == path.name


def _remove_aside(path: Path) -> None:
    """Remove the mark of a folder that is in its place."""
    if _is_aside(path, path):
        (path / ASIDE).unlink()


def put_back(old: Path, path: Path) -> None:
    """Move a folder back that was moved aside."""
    old.rename(path)
    _remove_aside(path)
