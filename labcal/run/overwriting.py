"""Overwriting: checks of the place of an output, and whether the output may replace what is there."""

import os
import stat
from collections.abc import Iterable
from pathlib import Path

from labcal.arguments import truth_value
from labcal.errors import OutputError
from labcal.run.foreign import foreign_entries
from labcal.run.made import made_in
from labcal.run.mounts import is_mount

UNFINISHED = ".unfinished"
"""Ending of the name of a folder under construction, next to the final one."""
OLD = ".labcal-old"
"""Ending of the name that a folder has while it is being replaced."""
_SHOWN = 3
"""The number of foreign entries that a message names."""
_KINDS = (
    (stat.S_ISCHR, "a device"),
    (stat.S_ISBLK, "a device"),
    (stat.S_ISFIFO, "a pipe"),
    (stat.S_ISSOCK, "a socket"),
)


def require_name(path: Path) -> None:
    """Raise if a path does not end in a name, as ``.``, ``..`` and ``/``.

    Raises
    ------
    OutputError
        It does.
    """
    if path.name in {"", ".."}:
        raise OutputError(
            f"{path} exists already, and is never replaced: it names the current folder, or one above. "
            "End the path with the name of the output."
        )


def require_file_place(path: Path, *, force: bool) -> None:
    """Raise if a file may not be written at `path`.

    Nothing but a regular file is ever replaced: no link (nor what it leads to), folder, device or mount.

    Raises
    ------
    OutputError
        Something is there that may not be replaced, or `force` is not set.
    """
    require_name(path)
    status = _status(path)
    if status is None:
        return
    _require_plain(path, status)
    if stat.S_ISDIR(status.st_mode):
        raise OutputError(f"{path} is a folder, but a file is to be written. Give the name of a file.")
    _require_leave(path, status, force=force)


def require_folder_place(path: Path, *, force: bool) -> None:
    """Raise if a folder may not be made at `path`.

    With `force` a folder is replaced if labcal made it (its mark states that) and it holds nothing else, or
    if it is empty. Never the current folder, the home folder, or one above them.

    Raises
    ------
    OutputError
        Something is there that may not be replaced, or `force` is not set.
    """
    require_name(path)
    for other in (working_place_of(path), old_place_of(path)):
        _status(other)  # raises where such a name is too long
    status = _status(path)
    if status is None:
        return
    _require_plain(path, status)
    if not stat.S_ISDIR(status.st_mode):
        exists = "" if force else f"{path} exists already. "
        raise OutputError(f"{exists}{path} is a file, but a folder is to be made. Choose another name.")
    require_elsewhere(path)
    _require_leave(path, status, force=force)
    if any(path.iterdir()):
        if made_in(path) is None:
            raise OutputError(
                f"{path} is not replaced: it has no mark of labcal, so another program made it, or an older "
                "version of labcal. Choose another name, or remove it yourself."
            )
        require_nothing_foreign(path)
    if os.path.lexists(old_place_of(path)):
        raise OutputError(
            f"{path} is not replaced: it would be kept as {old_place_of(path)} meanwhile, but that "
            "exists. Move it elsewhere."
        )


def require_nothing_foreign(folder: Path) -> None:
    """Raise if a folder holds anything that labcal did not make.

    Raises
    ------
    OutputError
        It does; the first few entries are named.
    """
    foreign = foreign_entries(folder)
    if foreign:
        more = f" and {len(foreign) - _SHOWN} more" if len(foreign) > _SHOWN else ""
        raise OutputError(
            f"{folder} is not replaced: it contains files or folders that labcal did not make: "
            f"{', '.join(foreign[:_SHOWN])}{more}. Choose another name, or move these elsewhere."
        )


def require_elsewhere(folder: Path) -> None:
    """Raise where a folder is the current one or the user's home, or holds one of them.

    Raises
    ------
    OutputError
        It does.
    """
    for what, home in (("the current folder", Path.cwd), ("your home folder", Path.home)):
        try:
            inside = holds(folder, [home()])
        except (OSError, RuntimeError):  # it has been removed, or there is none
            continue
        if inside:
            raise OutputError(f"{folder} is or holds {what}, which is never replaced. Name a folder to make.")


def holds(folder: Path, paths: Iterable[Path]) -> bool:
    """Return whether a folder is, or contains, one of these paths, whatever their spelling or links."""
    try:
        own = folder.stat()
    except OSError:
        return False
    for path in paths:
        for spelled in (path.absolute(), Path(os.path.realpath(path))):
            for home in (spelled, *spelled.parents):
                try:
                    if os.path.samestat(own, home.stat()):
                        return True
                except OSError:
                    continue
    return False


def working_place_of(path: Path) -> Path:
    """Return the path at which a folder is made, next to its final place."""
    return path.with_name(path.name + UNFINISHED)


def old_place_of(path: Path) -> Path:
    """Return the path at which a folder is kept while it is being replaced."""
    return path.with_name(path.name + OLD)


def _status(path: Path) -> os.stat_result | None:
    """Return the status of what is at a path (of a link, its own), or None if nothing is."""
    try:
        return path.lstat()
    except FileNotFoundError:
        return None
    except OSError as error:
        raise OutputError(f"{path} cannot be written: {error.strerror or error}.") from error


def _require_plain(path: Path, status: os.stat_result) -> None:
    """Raise if it is a link, a device, a mount or the like."""
    if stat.S_ISLNK(status.st_mode):
        raise OutputError(
            f"{path} exists already, as a link to {path.readlink()}. A link is not replaced, nor anything "
            "through it. Name the place itself, or remove the link."
        )
    for is_kind, kind in _KINDS:
        if is_kind(status.st_mode):
            raise OutputError(
                f"{path} exists already and is {kind}, which is never replaced: a result is written to a "
                "temporary file and then renamed. Give the name of a file."
            )
    if is_mount(path):
        raise OutputError(f"{path} exists already: a disk or folder is mounted there. Choose another name.")


def _require_leave(path: Path, status: os.stat_result, *, force: bool) -> None:
    """Raise unless the user allows replacement and the place is not write-protected."""
    if not truth_value(force, "force"):
        raise OutputError(f"{path} exists already. Choose another name, or add `force=True` to replace it.")
    if not status.st_mode & (stat.S_IWUSR | stat.S_IWGRP | stat.S_IWOTH):
        raise OutputError(
            f"{path} is write-protected, so it is not replaced. Choose another name, or lift the protection."
        )
