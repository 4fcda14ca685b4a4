"""Output files that appear whole or not at all, and never replace a file without permission."""

import errno
import os
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path
from tempfile import mkstemp
from threading import Lock

from labcal.errors import DiskFullError, OutputError
from labcal.run.durable import flush_file, flush_folder
from labcal.run.file_kinds import FileKind, require_no_part, require_replaceable
from labcal.run.made import SCRAP, note_made, unfinished_home
from labcal.run.overwriting import require_file_place

_NO_LINKS = {errno.EPERM, errno.ENOTSUP, errno.ENOSYS, errno.EMLINK, errno.EACCES, errno.EINVAL}
"""Error numbers of file systems that do not support hard links."""


@contextmanager
def appearing_file(path: Path, *, force: bool) -> Iterator[Path]:
    """Yield a temporary file that becomes `path` if the block succeeds, and is removed if not.

    It is on the disk before it gets its name, so that a power cut leaves the old file or the new one.

    Yields
    ------
    Path
        A hidden file in the folder of `path`, with the prefix of labcal's temporary files.

    Raises
    ------
    OutputError
        `path` exists and `force` is not set; it is no regular file; or it cannot be written (no such folder,
        no right, disk full).
    """
    require_file_place(path, force=force)
    temporary: Path | None = None
    try:
        descriptor, name = mkstemp(dir=path.parent, prefix=SCRAP)
        temporary = Path(name)
        os.close(descriptor)
        yield temporary
        temporary.chmod(0o666 & ~_umask())
        flush_file(temporary)
        note_made(path, temporary)
        _put_in_place(temporary, path, force=force)
        if unfinished_home(path) is None:  # else the whole folder is flushed before it gets its name
            flush_folder(path.parent)
    except OutputError:
        raise
    except OSError as error:
        raise refusal(path, error) from error
    finally:
        if temporary is not None:
            temporary.unlink(missing_ok=True)


def write_file(
    path: Path, content: bytes | memoryview | str, *, kind: FileKind | None = None, force: bool
) -> None:
    """Write a file whole, through a temporary file in its folder.

    Parameters
    ----------
    path : Path
    content : bytes, memoryview or str
    kind : FileKind, optional
        Of a file that is a result by itself, and so gets labcal's mark; left out for a part of a folder,
        which has a mark as a whole.
    force : bool
        Replace what exists; where a `kind` is given, only what labcal wrote.

    Raises
    ------
    OutputError
        As of :func:`appearing_file`; or what exists is not of the kind, or not labcal's, or a part of a
        finished folder.
    """
    data = content.encode() if isinstance(content, str) else content
    if kind is not None:
        data = kind.mark.put(bytes(data))
        if unfinished_home(path) is None:
            require_no_part(path)
    with appearing_file(path, force=force) as temporary:
        temporary.write_bytes(data)
        if kind is not None and force:
            require_replaceable(path, kind)  # late: a good deal of time may have gone by


def refusal(path: Path, error: OSError) -> OutputError:
    """Return the error for a path that the operating system refuses to write."""
    if error.errno in {errno.ENOSPC, errno.EDQUOT}:
        return DiskFullError(
            f"The disk is full: {path} cannot be written. Free some space, or write elsewhere."
        )
    return OutputError(f"{path} cannot be written: {error.strerror or error}.")


def name_exclusively(temporary: Path, path: Path) -> bool:
    """Rename a file in one atomic step; return False, and do nothing, if the name is taken."""
    try:
        os.link(temporary, path)
    except FileExistsError:
        return False
    except OSError as error:
        if error.errno not in _NO_LINKS:
            raise
        if os.path.lexists(path):
            return False
        temporary.rename(path)
        return True
    temporary.unlink()
    return True


def _put_in_place(temporary: Path, path: Path, *, force: bool) -> None:
    """Rename a file to its final name; without `force`, only if that is free."""
    if not force and name_exclusively(temporary, path):
        return
    require_file_place(path, force=force)  # again: a good deal of time may have gone by
    temporary.replace(path)


_UMASK = Lock()


def _umask() -> int:
    """Return the mask of rights, which can only be asked for by setting it: in one thread at a time."""
    with _UMASK:
        mask = os.umask(0o022)
        os.umask(mask)
    return mask
