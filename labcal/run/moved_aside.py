"""Replacement of folders: the old one is kept under another name until the new one is in place."""

import os
from pathlib import Path

from labcal.run.begun import COMMAND, begun_in
from labcal.run.durable import flush_file
from labcal.run.foreign import foreign_entries, remove_made
from labcal.run.lock import locked
from labcal.run.made import ASIDE, made_in
from labcal.run.overwriting import old_place_of, working_place_of


def recover(path: Path) -> None:
    """Complete or undo the replacement of `path` that an earlier run was killed in.

    Where the new folder is not in its place, the old one is put back; where it is, the old one is removed.
    Nothing is done unless labcal moved the old one there (its mark states that) and nothing else is in it;
    nor while another process is working.
    """
    for home in (working_place_of(path), path):
        if begun_in(home) is not None:
            with locked(home / COMMAND) as free:
                if not free:
                    return
    old = old_place_of(path)
    if not os.path.lexists(old):
        _remove_mark(path)  # killed before the old one was moved, or after it was moved back
        return
    if old.is_symlink() or not old.is_dir() or foreign_entries(old):
        return
    if not os.path.lexists(path):
        if _is_marked(old, path):
            restore(old, path)
        return
    replaced = begun_in(path) is not None and made_in(path) is not None
    if replaced and (_is_marked(old, path) or not any(old.iterdir())):  # it may have been about to be removed
        remove_made(old)


def mark_replaced(folder: Path) -> None:
    """Mark a folder that is about to be replaced; the mark holds the name to restore."""
    mark = folder / ASIDE
    mark.write_text(folder.name, encoding="utf-8", errors="surrogateescape")
    flush_file(mark)


def _is_marked(folder: Path, path: Path) -> bool:
    """Return whether a folder has the mark of the one that was at `path`."""
    mark = folder / ASIDE
    if folder.is_symlink() or mark.is_symlink() or not mark.is_file():
        return False
    return mark.read_text(encoding="utf-8", errors="surrogateescape") == path.name


def _remove_mark(path: Path) -> None:
    """Remove the mark of a folder that is in its place."""
    if _is_marked(path, path):
        (path / ASIDE).unlink()


def restore(old: Path, path: Path) -> None:
    """Move a replaced folder back to its place."""
    old.rename(path)
    _remove_mark(path)
