"""Files and folders that are on the disk, and not only in the memory of the operating system."""

import errno
import os
from collections.abc import Collection
from pathlib import Path

_NOT_OFFERED = {errno.EINVAL, errno.ENOTSUP, errno.ENOSYS, errno.EACCES, errno.EPERM, errno.EBADF}
"""Error numbers of systems on which a folder cannot be flushed."""


def flush_file(path: Path) -> None:
    """Wait until the content of a file is on the disk.

    Raises
    ------
    OSError
        The disk refuses it, perhaps because it is full.
    """
    descriptor = os.open(path, os.O_RDWR)  # Windows flushes no file that is open for reading only
    try:
        os.fsync(descriptor)
    finally:
        os.close(descriptor)


def flush_folder(folder: Path) -> None:
    """Wait until the names in a folder are on the disk, where the system offers that.

    Raises
    ------
    OSError
        The disk refuses it.
    """
    try:
        descriptor = os.open(folder, os.O_RDONLY)
    except PermissionError:  # Windows opens no folder
        return
    try:
        os.fsync(descriptor)
    except OSError as error:
        if error.errno not in _NOT_OFFERED:
            raise
    finally:
        os.close(descriptor)


def flush_tree(folder: Path, done: Collection[str]) -> None:
    """Wait until all files and folders below `folder`, and itself, are on the disk; links are not followed.

    Parameters
    ----------
    folder : Path
    done : collection of str
        Paths in the folder of files that have been flushed already: it takes milliseconds for each.

    Raises
    ------
    OSError
        The disk refuses one.
    """
    for home, _, names in os.walk(folder, topdown=False):
        for name in names:
            path = Path(home, name)
            if path.relative_to(folder).as_posix() in done:
                continue
            if path.is_file() and not path.is_symlink() and os.access(path, os.W_OK):
                flush_file(path)
        flush_folder(Path(home))
