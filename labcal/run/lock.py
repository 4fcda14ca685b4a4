"""A lock on a file that ends with the process that holds it, however that ends."""

from collections.abc import Iterator
from contextlib import contextmanager, suppress
from pathlib import Path


@contextmanager
def locked(path: Path) -> Iterator[bool]:
    """Lock a file that exists, and say whether that was possible: False where another process holds it.

    Where the system or its disk offers no locks (Windows, some network disks), nobody is kept out.
    """
    try:
        import fcntl  # noqa: PLC0415 -- POSIX only
    except ImportError:
        yield True
        return
    with path.open("rb") as handle:
        free = True
        with suppress(OSError):
            try:
                fcntl.flock(handle, fcntl.LOCK_EX | fcntl.LOCK_NB)
            except BlockingIOError:
                free = False
        yield free
