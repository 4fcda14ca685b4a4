"""Output folders that appear whole or not at all; an interrupted command resumes in them."""

import os
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path
from tempfile import mkstemp

from labcal.errors import OutputError
from labcal.run.begun import COMMAND, Begun, begun_in
from labcal.run.durable import flush_file, flush_folder, flush_tree
from labcal.run.foreign import foreign_entries, remove_made
from labcal.run.lock import locked
from labcal.run.made import (
    SCRAP,
    command_digest,
    made_in,
    mark_as_made,
    note_made,
    reopen,
)
from labcal.run.main_guard import end_unguarded_worker
from labcal.run.moved_aside import mark_replaced, recover, restore
from labcal.run.outputs import name_exclusively, refusal
from labcal.run.overwriting import (
    old_place_of,
    require_elsewhere,
    require_folder_place,
    require_name,
    require_nothing_foreign,
    working_place_of,
)


@contextmanager
def unfinished_folder(path: Path, command: str, *, force: bool) -> Iterator[Path]:
    """Yield a working folder that becomes `path` if the block succeeds.

    The folder of an interrupted run is used again if `command` and the code are the same, so that the work
    resumes; one that another command or another version of labcal began is refused. A run may be killed at
    any moment, also within this function. A folder that is replaced stays until the new one is whole and on
    the disk, then it is kept as ``NAME.labcal-old`` until the new one is in its place; if that fails it is
    moved back.

    Parameters
    ----------
    path : Path
        The folder to appear.
    command : str
        Everything that determines the content, as text; its first word is the verb.
    force : bool
        Replace `path`, and discard what another command or version left unfinished, where labcal made it and
        it holds nothing else (:mod:`labcal.run.overwriting`).

    Yields
    ------
    Path
        The folder ``<name>.unfinished`` next to `path`.

    Raises
    ------
    OutputError
        Something that may not be replaced, or another run, is in the way, or the disk refuses.
    """
    end_unguarded_worker()
    require_name(path)
    working, ours = working_place_of(path), Begun.now(command)
    try:
        recover(path)
        if not os.path.lexists(working) and not path.is_symlink() and begun_in(path) == ours:
            path.rename(working)  # killed after the work and before the mark was removed
        require_folder_place(path, force=force)
        require_working_place(path, command, force=force)
        theirs = begun_in(working)
        if theirs not in {None, ours}:
            with held(working, theirs):
                remove_made(working)  # nothing in it is foreign, as has just been seen
        begin(working, ours)
        with held(working, ours):
            require_no_linked_folder(working)
            remove_scraps(working)
            reopen(working)
            note_made(working, working)
            yield working
            remove_scraps(working)  # of workers that were killed
            _finish(working, path, command, force=force)
    except OutputError:
        raise
    except OSError as error:
        raise refusal(path, error) from error


def require_working_place(path: Path, command: str | None, *, force: bool) -> None:
    """Raise if the working folder of `path` may not be used.

    Parameters
    ----------
    path : Path
        The folder to appear.
    command : str, optional
        What will make it; where not given, an unfinished folder of any command is let pass.
    force : bool
        Another command's unfinished folder may be discarded.

    Raises
    ------
    OutputError
        The folder is unfinished output of another command or of another version of labcal, or was not made by
        labcal.
    """
    working = working_place_of(path)
    if not os.path.lexists(working):
        return
    theirs = begun_in(working)
    is_folder = working.is_dir() and not working.is_symlink()
    if not is_folder or (theirs is None and foreign_entries(working)):
        raise OutputError(
            f"{path.name} would be made in {working}, but that exists and is no unfinished output of "
            "this version of labcal. Move it elsewhere, or choose another name."
        )
    if theirs is not None:
        with held(working, theirs):
            pass
    if theirs is None or command is None or theirs == (ours := Begun.now(command)):
        return
    if not force and theirs.command != command:
        raise OutputError(
            f"{working} is the unfinished output of another command. Repeat that command to finish it, "
            "or add `force=True` to discard it."
        )
    if not force:
        raise OutputError(
            f"{working} was begun by {theirs.code}, but this is {ours.code}, and results of different "
            "code are not put together. Finish it with the code that began it, or add `force=True` to "
            "discard it and begin anew."
        )
    require_elsewhere(working)
    require_nothing_foreign(working)


def is_finished(path: Path, command: str) -> bool:
    """Tell whether a folder is the finished output of this command, with nothing changed or added since."""
    made = None if path.is_symlink() else made_in(path)
    return made is not None and made.command_sha256 == command_digest(command) and not foreign_entries(path)


def abandon(working: Path) -> None:
    """Remove everything made in an unfinished folder that is of no use."""
    remove_made(working)


def begin(working: Path, ours: Begun) -> None:
    """Make the folder, and mark it unless it is marked; only one of several processes does so."""
    working.mkdir(parents=True, exist_ok=True)
    if begun_in(working) is not None:
        return
    descriptor, name = mkstemp(dir=working, prefix=SCRAP)
    os.close(descriptor)
    scrap = Path(name)
    try:
        scrap.write_text(ours.text(), encoding="utf-8")
        flush_file(scrap)
        name_exclusively(scrap, working / COMMAND)  # the mark is there whole or not at all
    except FileNotFoundError as error:  # another one has it, and removes what it takes for scraps
        raise _at_work(working) from error
    finally:
        scrap.unlink(missing_ok=True)


@contextmanager
def held(working: Path, begun: Begun | None) -> Iterator[None]:
    """Lock an unfinished folder that has a mark.

    Raises
    ------
    OutputError
        Another one is at work in it, or has just ended.
    """
    with locked(working / COMMAND) as free:
        if not free or begun_in(working) != begun:
            raise _at_work(working)
        yield


def _at_work(working: Path) -> OutputError:
    """Return the error for an unfinished folder in which another process works."""
    return OutputError(f"Another labcal process works in {working}. Wait until it has ended.")


def require_no_linked_folder(working: Path) -> None:
    """Raise if an inner folder is a link, through which files elsewhere would be changed."""
    for home, folders, _ in os.walk(working):
        for path in (Path(home, name) for name in folders):
            if path.is_symlink():
                raise OutputError(
                    f"{working} cannot be resumed: {path.relative_to(working)} in it is a link to a folder "
                    "elsewhere. Remove the link."
                )


def remove_scraps(working: Path) -> None:
    """Remove files that were being written when an earlier run was killed."""
    for home, _, names in os.walk(working):
        for name in names:
            if name.startswith(SCRAP):
                Path(home, name).unlink()


def _finish(working: Path, path: Path, command: str, *, force: bool) -> None:
    """Put the folder in its place."""
    made = mark_as_made(working, command)
    flush_tree(working, made.files.keys())
    require_folder_place(path, force=force)  # again: a good deal of time may have gone by
    note_made(path, working)
    put_in_place(working, path)
    (path / COMMAND).unlink()
    flush_folder(path)


def put_in_place(working: Path, path: Path) -> None:
    """Rename a folder to its final name; what labcal made there before is kept until the new one is there.

    Raises
    ------
    OutputError
        What is in the place holds anything that labcal did not make.
    """
    old, replaces = old_place_of(path), os.path.lexists(path)
    try:
        if replaces:
            mark_replaced(path)
            path.rename(old)
            require_nothing_foreign(old)
        working.rename(path)
    except BaseException:
        if replaces and os.path.lexists(old) and not os.path.lexists(path):
            restore(old, path)
        raise
    flush_folder(path.parent)
    if replaces:
        remove_made(old)
