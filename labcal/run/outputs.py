"""Results on disk that appear whole or not at all, and never over something else unasked."""

import errno
import os
import shutil
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path
from tempfile import NamedTemporaryFile

from labcal.errors import DiskFullError, OutputError
from labcal.run.main_guard import end_unguarded_worker


def refuse_existing(path: Path, *, force: bool) -> None:
    """Raise where `path` exists and may not be replaced.

    Raises
    ------
    OutputError
        `path` exists and `force` is not set.
    """
    if path.exists() and not force:
        raise OutputError(f"{path} exists already. Choose another name, or add --force to replace it.")


def refuse_homeless(path: Path) -> None:
    """Raise where the folder that a file should appear in does not exist.

    Raises
    ------
    OutputError
        There is no such folder.
    """
    if not path.parent.exists():
        raise OutputError(f"{path} cannot be written: there is no folder {path.parent}. Create it first.")


@contextmanager
def appearing_file(path: Path, *, force: bool) -> Iterator[Path]:
    """Give an empty file to fill that becomes `path` when that went well, and is removed when not.

    Yields
    ------
    Path
        A hidden file beside `path`.

    Raises
    ------
    OutputError
        `path` exists and `force` is not set, or it cannot be written (no such folder, no right, disk full).
    """
    refuse_existing(path, force=force)
    temporary: Path | None = None
    try:
        with NamedTemporaryFile(dir=path.parent, prefix=f".{path.name}.", delete=False) as handle:
            temporary = Path(handle.name)
        yield temporary
        temporary.chmod(0o666 & ~_umask())
        temporary.replace(path)
    except OutputError:
        raise
    except OSError as error:
        raise _refusal(path, error) from error
    finally:
        if temporary is not None:
            temporary.unlink(missing_ok=True)


def write_file(path: Path, content: bytes | memoryview | str, *, force: bool) -> None:
    """Write a file whole, through a temporary file beside it.

    Raises
    ------
    OutputError
        The file exists and `force` is not set, or it cannot be written (no such folder, no right, disk full).
    """
    with appearing_file(path, force=force) as temporary:
        temporary.write_bytes(content.encode() if isinstance(content, str) else content)


def _refusal(path: Path, error: OSError) -> OutputError:
    """Return what to raise where the operating system refuses to write `path`."""
    if error.errno in {errno.ENOSPC, errno.EDQUOT}:
        return DiskFullError(
            f"The disk is full: {path} cannot be written. Free some space, or write elsewhere."
        )
    return OutputError(f"{path} cannot be written: {error.strerror or error}.")


def _umask() -> int:
    mask = os.umask(0o022)
    os.umask(mask)
    return mask


MARK = ".command"
"""The file in an unfinished folder that holds the command which is making it."""


def _command_in(folder: Path) -> str | None:
    """Return the command that a folder is marked with, if it is."""
    mark = folder / MARK
    return mark.read_text(encoding="utf-8", errors="replace") if mark.is_file() else None


def _remove_scraps(working: Path) -> None:
    """Remove files that were being written when a run, or one of its workers, was killed."""
    for path in working.rglob(".*"):
        if path.is_file() and path.name != MARK:
            path.unlink()


def _discard_unfinished(working: Path, *, force: bool) -> None:
    """Remove what another command left unfinished, or refuse to."""
    if not force:
        raise OutputError(
            f"{working} is the unfinished output of another command. Repeat that command to finish it, "
            "or add --force to discard it."
        )
    shutil.rmtree(working)


@contextmanager
def unfinished_folder(path: Path, command: str, *, force: bool) -> Iterator[Path]:
    """Give a folder to work in that becomes `path` when the work ends well.

    What an interrupted run left behind is given again when `command` is the same, so that the work resumes;
    what another command left is refused. A run may be killed at any moment, also as it begins or ends here.

    Parameters
    ----------
    path : Path
        The folder to appear.
    command : str
        Everything that determines the content, as text.
    force : bool
        Replace `path`, and discard what another command left unfinished.

    Yields
    ------
    Path
        The folder ``<name>.unfinished`` beside `path`.

    Raises
    ------
    OutputError
        `path` exists, another command's unfinished output is in the way, or the disk refuses.
    """
    end_unguarded_worker()
    working = path.with_name(path.name + ".unfinished")
    try:
        if not working.exists() and _command_in(path) == command:
            path.replace(working)  # killed after the work and before the mark was removed
        refuse_existing(path, force=force)
        if working.exists():
            _remove_scraps(working)
            if any(working.iterdir()) and _command_in(working) != command:
                _discard_unfinished(working, force=force)
        working.mkdir(parents=True, exist_ok=True)
        if _command_in(working) is None:
            scrap = working / f"{MARK}.part"
            scrap.write_text(command, encoding="utf-8")
            scrap.replace(working / MARK)  # the mark is there whole or not at all
        yield working
        _remove_scraps(working)
        if path.exists():
            shutil.rmtree(path) if path.is_dir() else path.unlink()
        working.replace(path)
        (path / MARK).unlink()
    except OutputError:
        raise
    except OSError as error:
        raise _refusal(path, error) from error
