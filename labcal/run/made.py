"""Marks by which labcal recognises its own files and folders.

While a folder is being made it holds the command (:mod:`labcal.run.begun`) and a list of what is written
(:data:`JOURNAL`); when it is done, one file that lists all that labcal made (:data:`MADE`). Whatever is not
listed, or has been changed since, counts as foreign. Another mark is in a folder while it is being replaced
(:data:`ASIDE`).
"""

import hashlib
import json
import os
from collections.abc import Mapping
from contextlib import suppress
from pathlib import Path, PurePosixPath
from typing import Literal

from pydantic import BaseModel, ConfigDict, ValidationError

from labcal.run.begun import COMMAND
from labcal.run.durable import flush_file, flush_folder
from labcal.run.file_marks import JSON_KEY, Judgement

JOURNAL = ".labcal-written"
"""In an unfinished folder: a line for each file that has been written."""
MADE = ".labcal-made"
"""In a finished folder: what labcal made in it."""
ASIDE = ".labcal-aside"
"""In a folder that is being replaced: its name."""
MARKS = (JOURNAL, COMMAND, MADE, ASIDE)
SCRAP = ".labcal-part-"
"""Prefix of the names of files that are being written."""
PROVENANCE = "run.json"
"""Times and versions, which differ from run to run: its digest would make the folder's mark differ, too, so
it has a mark of its own (:func:`provenance_text`)."""


class Made(BaseModel):
    """The content of :data:`MADE`."""

    model_config = ConfigDict(frozen=True, extra="forbid")

    format: Literal["labcal-made"] = "labcal-made"
    format_version: Literal[1] = 1
    made_by: str
    """The verb."""
    command_sha256: str | None = None
    """Of everything that determines the content; null in a mark of an older version."""
    files: dict[str, str | None]
    """SHA-256 by path in the folder; null for :data:`PROVENANCE`, which has it in itself."""
    homes: tuple[str, ...] = ()
    """Folders inside that are there for files."""
    folders: tuple[str, ...] = ()
    """Finished folders inside, each with a mark of its own."""

    @property
    def all_folders(self) -> set[str]:
        """All inner folders, including those that only hold files."""
        homes = {name.rpartition("/")[0] for name in (*self.files, *self.folders)}
        homes |= {*self.homes, *self.folders}
        return {str(home) for one in homes for home in (PurePosixPath(one), *PurePosixPath(one).parents)}


def unfinished_home(path: Path) -> Path | None:
    """Return the folder under construction that a path lies in, the innermost one, if any."""
    return next((home for home in path.absolute().parents if (home / COMMAND).is_file()), None)


def provenance_text(content: Mapping[str, object]) -> bytes:
    """Return the bytes to write into :data:`PROVENANCE`."""
    return JSON_KEY.put(json.dumps(content, indent=2).encode() + b"\n")


def is_unchanged(path: Path, digest: str | None) -> bool:
    """Return whether a listed file is as labcal wrote it; without a digest, by the mark inside the file."""
    if digest is None:
        return JSON_KEY.judge(path.read_bytes()) is Judgement.AS_WRITTEN
    return digest_of(path) == digest


def note_made(path: Path, content: Path) -> None:
    """Note in the folder under construction that labcal makes this file; do nothing elsewhere.

    Call it before the file appears, so that no file is there without a note.

    Parameters
    ----------
    path : Path
        Where it will be.
    content : Path
        Where its content is now, or `path` itself. A finished folder is noted as such.
    """
    home = unfinished_home(path)
    if home is not None:
        name = path.absolute().relative_to(home).as_posix()
        is_folder = content.is_dir()
        _note(home, {"folder": name} if is_folder else {"file": name, "sha256": digest_of(content)})


def make_folder(folder: Path) -> None:
    """Make a folder for files, unless it is there, and note it like a file (:func:`note_made`)."""
    home = unfinished_home(folder)
    if home is not None and not folder.exists():
        _note(home, {"home": folder.absolute().relative_to(home).as_posix()})
    folder.mkdir(parents=True, exist_ok=True)


def _note(home: Path, note: dict[str, str]) -> None:
    """Append a line to the list of written files; an incomplete line before it does no harm."""
    line = f"\n{json.dumps(note)}\n".encode()
    # Workers append at the same time: a line in one piece, at the end of the file. It is not flushed to
    # the disk: a file whose line a power cut takes from the list counts as foreign, and stays.
    descriptor = os.open(home / JOURNAL, os.O_WRONLY | os.O_APPEND | os.O_CREAT, 0o666)
    try:
        os.write(descriptor, line)
    finally:
        os.close(descriptor)


def command_digest(command: str) -> str:
    """Return the SHA-256 of a command."""
    return hashlib.sha256(command.encode()).hexdigest()


def mark_as_made(folder: Path, command: str) -> Made:
    """Convert the list of written files of a folder into the mark of a finished folder, and return it.

    `command` is everything that determines the content, as text; its first word is the verb.
    """
    noted = noted_in(folder)
    names = [name for name in sorted(noted.files) if (folder / name).is_file()]
    kept = {
        name: None
        if Path(name).name == PROVENANCE and is_unchanged(folder / name, None)
        else noted.files[name]
        for name in names
    }
    homes, inside = (
        tuple(name for name in sorted(set(names)) if (folder / name).is_dir())
        for names in (noted.homes, noted.folders)
    )
    made = Made(
        made_by=command.split(maxsplit=1)[0],
        command_sha256=command_digest(command),
        files=kept,
        homes=homes,
        folders=inside,
    )
    _write_mark(folder, made)
    (folder / JOURNAL).unlink(missing_ok=True)
    return made


def reopen(folder: Path) -> None:
    """Convert the mark of a finished folder, if it has one, back into the list of written files."""
    made = made_in(folder)
    if made is None:
        return
    if not (folder / JOURNAL).exists():
        notes: list[dict[str, str | None]] = [{"folder": name} for name in made.folders]
        notes += [{"home": name} for name in made.homes]
        notes += [{"file": name, "sha256": digest} for name, digest in made.files.items()]
        scrap = folder / f"{SCRAP}journal"
        scrap.write_text("".join(json.dumps(note) + "\n" for note in notes), encoding="utf-8")
        scrap.replace(folder / JOURNAL)
    (folder / MADE).unlink()


def is_as_made(path: Path) -> bool:
    """Return whether a file is listed in the mark of its folder, and still as labcal wrote it."""
    made = made_in(path.parent)
    return (
        made is not None
        and path.name in made.files
        and path.is_file()
        and is_unchanged(path, made.files[path.name])
    )


def renew(path: Path) -> None:
    """Update the digest of a rewritten file in the mark of its folder, if there is one."""
    made = made_in(path.parent)
    if made is not None:
        files = dict(sorted({**made.files, path.name: digest_of(path)}.items()))
        _write_mark(path.parent, made.model_copy(update={"files": files}))


def made_in(folder: Path) -> Made | None:
    """Return the mark of a finished folder; None if there is none that this version can read."""
    path = folder / MADE
    if path.is_symlink() or not path.is_file():
        return None
    with suppress(OSError, ValidationError):
        return Made.model_validate_json(path.read_bytes())
    return None


def noted_in(folder: Path) -> Made:
    """Return the list of an unfinished folder; incomplete lines are ignored."""
    files: dict[str, str | None] = {}
    homes: list[str] = []
    folders: list[str] = []
    path = folder / JOURNAL
    lines = path.read_bytes().splitlines() if path.is_file() and not path.is_symlink() else []
    for line in lines:
        with suppress(ValueError, KeyError, TypeError):
            note = json.loads(line)
            if "folder" in note:
                folders.append(str(note["folder"]))
            elif "home" in note:
                homes.append(str(note["home"]))
            else:
                files[str(note["file"])] = note["sha256"]
    return Made(made_by="", files=files, homes=tuple(homes), folders=tuple(folders))


def _write_mark(folder: Path, made: Made) -> None:
    """Write the mark whole."""
    scrap = folder / f"{SCRAP}made"
    scrap.write_text(made.model_dump_json(indent=1) + "\n", encoding="utf-8")
    flush_file(scrap)
    scrap.replace(folder / MADE)
    flush_folder(folder)


def digest_of(path: Path) -> str:
    """Return the SHA-256 of a file, as hexadecimal digits."""
    with path.open("rb") as handle:
        return hashlib.file_digest(handle, "sha256").hexdigest()
