"""A lock on a file, which ends with the process that holds it."""

import os
from collections.abc import Iterator
from contextlib import contextmanager, suppress
from pathlib import Path


@contextmanager
def locked(path: Path) -> Iterator[bool]:
    """Lock a file that exists, and yield whether that succeeded.

    It was not where another process holds it, or has meanwhile put another file in its place, or none.

    Where the system or its disk offers no locks (Windows, some network disks), the lock always succeeds.
    """
    try:
        import fcntl  # noqa: PLC0415 -- POSIX only
    except ImportError:
        yield True
        return
    try:
        handle = path.open("rb")
    except FileNotFoundError:
        yield False
        return
    with handle:
        free = True
        with suppress(OSError):
            try:
                fcntl.flock(handle, fcntl.LOCK_EX | fcntl.LOCK_NB)
            except BlockingIOError:
                free = False
        with suppress(OSError):
            free = free and os.path.lexists(path) and os.path.samestat(os.fstat(handle.fileno()), path.stat())
        yield free
