"""Output folders that are in their place from their first part on, and whole after every part."""

from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path

from labcal.errors import OutputError
from labcal.run.begun import COMMAND, Begun, begun_in
from labcal.run.durable import flush_folder, flush_tree
from labcal.run.foreign import remove_made
from labcal.run.made import mark_as_made, noted_in
from labcal.run.outputs import refusal
from labcal.run.overwriting import (
    require_folder_place,
    require_name,
    require_nothing_foreign,
    working_place_of,
)
from labcal.run.unfinished import (
    begin,
    held,
    put_in_place,
    remove_scraps,
    require_no_linked_folder,
    require_working_place,
)


class GrowingFolder:
    """A folder to which a command adds part after part.

    Attributes
    ----------
    path : Path
        Where the next part is written: next to the folder's place until :meth:`show`, in its place from then
        on.
    """

    def __init__(self, place: Path, path: Path, *, force: bool) -> None:
        self._place, self._force = place, force
        self.path = path

    @property
    def is_shown(self) -> bool:
        """True once the folder is in its place."""
        return self.path == self._place

    def show(self) -> None:
        """Put all that has been written onto the disk and, at the first time, the folder in its place."""
        flush_tree(self.path, noted_in(self.path).files.keys())
        if not self.is_shown:
            require_folder_place(self._place, force=self._force)
            put_in_place(self.path, self._place)
            self.path = self._place


@contextmanager
def growing_folder(path: Path, command: str, *, force: bool) -> Iterator[GrowingFolder]:
    """Yield a folder that grows; where the block succeeds it is finished, else what is in it stays.

    The folder of a run that was interrupted, or that failed, is gone on with by the same command. A folder
    that is replaced stays until the first part of the new one is shown.

    Parameters
    ----------
    path : Path
        The folder to appear.
    command : str
        Everything that determines the content, as text; its first word is the verb.
    force : bool
        Replace `path` where labcal made it and it holds nothing else.

    Raises
    ------
    OutputError
        Something that may not be replaced, or another run, is in the way, or the disk refuses.
    """
    require_name(path)
    ours = Begun.now(command)
    try:
        folder = GrowingFolder(path, _begun_place(path, ours, force=force), force=force)
        begin(folder.path, ours)
        with held(folder.path, ours):
            require_no_linked_folder(folder.path)
            remove_scraps(folder.path)
            yield folder
            if not folder.is_shown:
                folder.show()
            mark_as_made(path, command)
            (path / COMMAND).unlink()
            flush_folder(path)
    except OutputError:
        raise
    except OSError as error:
        raise refusal(path, error) from error


def _begun_place(path: Path, ours: Begun, *, force: bool) -> Path:
    """Return the folder to go on in, after everything that is in the way is removed."""
    theirs = begun_in(path) if path.is_dir() and not path.is_symlink() else None
    if theirs == ours:
        return path
    if theirs is not None and force:
        require_nothing_foreign(path)
        with held(path, theirs):
            remove_made(path)
    elif theirs is not None:
        raise OutputError(
            f"{path} is the unfinished output of another command or another version of labcal. Repeat that "
            "command to finish it, or add `force=True` to replace it."
        )
    require_folder_place(path, force=force)
    require_working_place(path, ours.command, force=force)
    working = working_place_of(path)
    if begun_in(working) not in {None, ours}:
        remove_made(working)
    return working
