"""Kinds of files that are results by themselves, and checks whether labcal may replace one."""

import os
import unicodedata
from collections.abc import Callable
from dataclasses import dataclass
from pathlib import Path

from labcal.errors import OutputError
from labcal.run.file_marks import FileMark, FormatMark, Judgement
from labcal.run.made import PROVENANCE, made_in

_MOST_BYTES = 1 << 30
"""labcal writes no larger file."""
_SHOOT = "shoot.json"
_OF_A_SHOOT = frozenset({"images", "truth"})


@dataclass(frozen=True)
class FileKind:
    """A kind of file, and the functions that recognise it."""

    name: str
    """Its name in messages: ``"a table of detections"``."""
    recognises: Callable[[bytes], bool]
    """A function that tells from a file's content whether it is of the kind, whichever program wrote it."""
    mark: FileMark
    """The mark that tells whether labcal wrote it."""


def recognised_by(name: str, is_of_kind: Callable[[bytes], bool]) -> FileKind:
    """Return a kind of file that only labcal writes, by the function that recognises it."""
    return FileKind(name, is_of_kind, FormatMark(is_of_kind))


def beginning_with(name: str, *starts: bytes) -> FileKind:
    """Return a kind of file that only labcal writes, by the bytes that it may begin with."""
    return recognised_by(name, lambda content: content.startswith(starts))


def require_replaceable(path: Path, kind: FileKind) -> None:
    """Raise unless nothing is at `path`, an empty file, or one of the kind as labcal wrote it.

    Raises
    ------
    OutputError
        It is something else, or cannot be read.
    """
    try:
        size = path.stat().st_size
        content = path.read_bytes() if size <= _MOST_BYTES else b""
    except FileNotFoundError:
        return
    except OSError as error:
        reason = f"it cannot be read ({error.strerror}), so it is not known whether labcal made it"
        raise OutputError(_refusal(path, reason)) from error
    if size > _MOST_BYTES:
        raise OutputError(_refusal(path, f"it is too large to be {kind.name} of labcal"))
    if size == 0:
        return
    if not kind.recognises(content):
        raise OutputError(_refusal(path, f"it is not {kind.name}, but something else"))
    judgement = kind.mark.judge(content)
    if judgement is Judgement.CHANGED:
        raise OutputError(_refusal(path, "it has been changed since labcal wrote it"))
    if judgement is Judgement.UNMARKED:
        reason = "it has no mark of labcal, so another program made it, or an older version of labcal"
        raise OutputError(_refusal(path, reason))


def require_no_part(path: Path, but_of: Path | None = None) -> None:
    """Raise where a file is, or would be, a part of a finished folder or of a shoot.

    Such a folder lists its files (``.labcal-made``), or holds ``shoot.json``: whatever is in its ``images/``
    and ``truth/`` is data then, whichever program wrote it.

    Parameters
    ----------
    path : Path
    but_of : Path, optional
        A folder that it may be a part of.

    Raises
    ------
    OutputError
        It is.
    """
    entry = Path(os.path.realpath(path.parent), path.name)
    for home in entry.parents:
        if but_of is not None and home == Path(os.path.realpath(but_of)):
            continue
        name = entry.relative_to(home)
        made = made_in(home)
        listed = [] if made is None else list(made.files)
        is_shoot = (home / _SHOOT).is_file()
        if is_shoot:
            listed += [_SHOOT, PROVENANCE]
        if any(_same(entry, name, home, one) for one in listed):
            raise OutputError(_part(path, home))
        if is_shoot and os.path.lexists(entry) and name.parts[0].casefold() in _OF_A_SHOOT:
            raise OutputError(_part(path, home))


def _same(entry: Path, name: Path, home: Path, listed: str) -> bool:
    """Tell whether a name is the one that a folder lists, also on a disk that ignores capital letters."""
    spelled = name.as_posix()
    if spelled == listed:
        return True
    if unicodedata.normalize("NFC", spelled).casefold() != unicodedata.normalize("NFC", listed).casefold():
        return False
    try:
        return entry.samefile(home / listed)
    except OSError:
        return False


def _part(path: Path, home: Path) -> str:
    return f"{path} cannot be written: a file of that name belongs to the folder {home}. Choose another name."


def _refusal(path: Path, reason: str) -> str:
    return f"{path} is not replaced: {reason}. Choose another name, or remove it yourself."
