"""What may stand at the place of an output, and be replaced by it."""

import os
import stat
from collections.abc import Iterable
from pathlib import Path

from labcal.errors import OutputError
from labcal.run.foreign import foreign_entries
from labcal.run.made import made_in
from labcal.run.mounts import is_mount

UNFINISHED = ".unfinished"
"""Ending of the name of a folder under construction, beside the one to appear."""
OLD = ".labcal-old"
"""Ending of the name that a folder gets while another one takes its place."""
_SHOWN = 3
"""So many foreign entries are named."""
_KINDS = (
    (stat.S_ISCHR, "a device"),
    (stat.S_ISBLK, "a device"),
    (stat.S_ISFIFO, "a pipe"),
    (stat.S_ISSOCK, "a socket"),
)


def require_name(path: Path) -> None:
    """Raise where a path ends in no name, as ``.``, ``..`` and ``/`` do.

    Raises
    ------
    OutputError
        It does.
    """
    if path.name in {"", ".."}:
        raise OutputError(
            f"{path} exists already, and is never replaced: it names the current folder, or one above. "
            "End the path with the name of what shall appear."
        )


def require_file_place(path: Path, *, force: bool) -> None:
    """Raise where a file may not appear at `path`.

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
    """Raise where a folder may not appear at `path`.

    With `force` a folder is replaced that labcal made, as its mark says, and that holds nothing else; an
    empty one, too. Never the current folder, the home folder, or one above them.

    Raises
    ------
    OutputError
        Something is there that may not be replaced, or `force` is not set.
    """
    require_name(path)
    for other in (working_of(path), old_of(path)):
        _status(other)  # raises where such a name is too long
    status = _status(path)
    if status is None:
        return
    _require_plain(path, status)
    if not stat.S_ISDIR(status.st_mode):
        told = "" if force else f"{path} exists already. "
        raise OutputError(f"{told}{path} is a file, but a folder is to be made. Choose another name.")
    require_elsewhere(path)
    _require_leave(path, status, force=force)
    if any(path.iterdir()):
        if made_in(path) is None:
            raise OutputError(
                f"{path} is not replaced, for it has no mark of labcal's: somebody else made it, or an older "
                "version. Choose another name, or remove it yourself."
            )
        require_nothing_foreign(path)
    if os.path.lexists(old_of(path)):
        raise OutputError(
            f"{path} is not replaced: {old_of(path)} is in the way, where it would be kept meanwhile. Move "
            "that elsewhere."
        )


def require_nothing_foreign(folder: Path) -> None:
    """Raise where a folder holds anything that labcal did not make.

    Raises
    ------
    OutputError
        It does; the first few entries are named.
    """
    foreign = foreign_entries(folder)
    if foreign:
        more = f" and {len(foreign) - _SHOWN} more" if len(foreign) > _SHOWN else ""
        raise OutputError(
            f"{folder} is not replaced, for it holds what labcal did not make: "
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
    """Return whether a folder is one of these paths or, by whatever spelling or link, holds one."""
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


def working_of(path: Path) -> Path:
    """Return where a folder is made, beside its place."""
    return path.with_name(path.name + UNFINISHED)


def old_of(path: Path) -> Path:
    """Return where a folder is kept while another one takes its place."""
    return path.with_name(path.name + OLD)


def _status(path: Path) -> os.stat_result | None:
    """Return what is at a path, a link as such; None where nothing is."""
    try:
        return path.lstat()
    except FileNotFoundError:
        return None
    except OSError as error:
        raise OutputError(f"{path} cannot be written: {error.strerror or error}.") from error


def _require_plain(path: Path, status: os.stat_result) -> None:
    """Raise unless it is a file or a folder in its own right."""
    if stat.S_ISLNK(status.st_mode):
        raise OutputError(
            f"{path} exists already, as a link to {path.readlink()}. A link is not replaced, nor anything "
            "through it. Name the place itself, or remove the link."
        )
    for is_kind, kind in _KINDS:
        if is_kind(status.st_mode):
            raise OutputError(
                f"{path} exists already and is {kind}, which is never replaced: results are written whole "
                "and then get their name. Give the name of a file."
            )
    if is_mount(path):
        raise OutputError(f"{path} exists already: something is mounted there. Choose another name.")


def _require_leave(path: Path, status: os.stat_result, *, force: bool) -> None:
    """Raise unless the user has said that it may be replaced, and has not protected it."""
    if not force:
        raise OutputError(f"{path} exists already. Choose another name, or add `force=True` to replace it.")
    if not status.st_mode & (stat.S_IWUSR | stat.S_IWGRP | stat.S_IWOTH):
        raise OutputError(
            f"{path} is write-protected, so it is not replaced. Choose another name, or lift the protection."
        )
