"""Claims of outputs: all that a command reads and writes is checked before its work begins."""

import os
import unicodedata
from collections.abc import Iterable, Sequence
from dataclasses import dataclass
from itertools import combinations
from pathlib import Path

from labcal.errors import OutputError
from labcal.run.file_kinds import FileKind, require_no_part, require_replaceable
from labcal.run.made import unfinished_home
from labcal.run.moved_aside import recover
from labcal.run.overwriting import (
    holds,
    old_place_of,
    require_file_place,
    require_folder_place,
    require_name,
    working_place_of,
)
from labcal.run.unfinished import require_working_place


@dataclass(frozen=True)
class FileOutput:
    """A file to write; with ``--force`` it replaces one of its kind that labcal wrote, or an empty one."""

    path: Path
    kind: FileKind
    part_of: Path | None = None
    """The finished folder that it is a part of, where the command puts it into the folder's mark."""


@dataclass(frozen=True)
class FolderOutput:
    """A folder to make; with ``--force`` it replaces one that labcal made and that holds nothing else."""

    path: Path
    command: str | None = None
    """The `command` of :func:`~labcal.run.unfinished.unfinished_folder`, if it is known already."""


Output = FileOutput | FolderOutput


def claim_outputs(outputs: Sequence[Output], inputs: Iterable[str | Path], *, force: bool) -> None:
    """Raise if one of a command's outputs may not be written, before any work is done.

    Everything is looked at again when it is put in its place
    (:func:`~labcal.run.outputs.write_file`, :func:`~labcal.run.unfinished.unfinished_folder`), except for
    the inputs, which only this function knows.

    Parameters
    ----------
    outputs : sequence of Output
        All that the command writes.
    inputs : iterable of str or Path
        All that it reads; names that are no paths do no harm. Of a folder, itself and the files in it.
    force : bool
        Replace what exists, as far as that is ever done.

    Raises
    ------
    OutputError
        An output is an input or holds one; two outputs are the same or inside each other; one lies in an
        unfinished folder, or is a part of a finished one; something is in its place that may not be
        replaced; or its folder is missing or not writable.
    """
    given = [Path(one) for one in inputs if os.path.lexists(one)]
    for output in outputs:
        require_name(output.path)
    for first, second in combinations(outputs, 2):
        _require_apart(first, second)
    for output in outputs:
        _require_no_input(output, given)
        home = unfinished_home(_entry(output.path))
        if home is not None:
            raise OutputError(
                f"{output.path} cannot be written: {home} is a folder that another command has not finished. "
                "Choose another place."
            )
        if isinstance(output, FolderOutput):
            _claim_folder(output, force=force)
        else:
            _claim_file(output, force=force)


def _claim_file(output: FileOutput, *, force: bool) -> None:
    path = output.path
    require_no_part(path, output.part_of)
    require_file_place(path, force=force)
    if not path.parent.exists():
        raise OutputError(f"{path} cannot be written: there is no folder {path.parent}. Create it first.")
    _require_writable(path, path.parent)
    require_replaceable(path, output.kind)


def _claim_folder(output: FolderOutput, *, force: bool) -> None:
    path = output.path
    try:
        recover(path)
    except OSError as error:
        raise OutputError(f"{path} cannot be written: {error.strerror or error}.") from error
    require_folder_place(path, force=force)
    require_working_place(path, output.command, force=force)
    _require_writable(path, next(home for home in path.absolute().parents if home.exists()))


def _require_writable(path: Path, home: Path) -> None:
    """Raise where nothing can be made in a folder."""
    if not home.is_dir():
        raise OutputError(f"{path} cannot be written: Not a directory. {home} is a file.")
    if not os.access(home, os.W_OK | os.X_OK):
        raise OutputError(f"{path} cannot be written: Permission denied. {home} is not yours to write in.")


def _require_no_input(output: Output, inputs: Sequence[Path]) -> None:
    """Raise where an output would replace what the command reads."""
    for place in _places(output):
        for one in inputs:
            if _same(place, one):
                raise OutputError(
                    f"{output.path} cannot be written: {place} is an input of this command, too. Choose "
                    "another name."
                )
        if isinstance(output, FolderOutput) and holds(place, inputs):
            raise OutputError(
                f"{output.path} cannot be written: {place} holds an input of this command. Choose "
                "another name."
            )


def _same(first: Path, second: Path) -> bool:
    """Return whether two paths lead to the same file or folder."""
    try:
        return first.samefile(second)
    except OSError:  # one of them leads to nothing
        return False


def _require_apart(first: Output, second: Output) -> None:
    """Raise where two outputs are the same, or one is inside the other."""
    for one in map(_spelled, _places(first)):
        for other in map(_spelled, _places(second)):
            if one == other[: len(one)] or other == one[: len(other)]:
                raise OutputError(
                    f"{first.path} and {second.path} are outputs of the same command, but they are the same, "
                    "or one is inside the other. Give them different names (in more than capitals)."
                )


def _places(output: Output) -> list[Path]:
    """Return the directory entries that an output needs."""
    entry = _entry(output.path)
    return (
        [entry, working_place_of(entry), old_place_of(entry)] if isinstance(output, FolderOutput) else [entry]
    )


def _entry(path: Path) -> Path:
    """Return a path with the links in the folders above it resolved, but not in itself."""
    return Path(os.path.realpath(path.parent), path.name)


def _spelled(path: Path) -> tuple[str, ...]:
    """Return the parts of a path in the form of a file system that ignores case and Unicode composition."""
    return tuple(unicodedata.normalize("NFC", part).casefold() for part in path.parts)
