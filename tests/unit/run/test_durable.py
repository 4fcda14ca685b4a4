"""In which order things reach the disk, seen from outside: what is flushed before and after each renaming."""

import errno
import os
from pathlib import Path
from typing import NoReturn

import pytest

from labcal.errors import DiskFullError
from labcal.run.durable import flush_folder
from labcal.run.outputs import write_file
from labcal.run.unfinished import unfinished_folder

Event = tuple[str, ...]


@pytest.fixture
def events(monkeypatch: pytest.MonkeyPatch) -> list[Event]:
    """What the operating system is asked for: ``("flush", path)``, ``("name", from, to)``."""
    seen: list[Event] = []
    opened: dict[int, str] = {}
    real_open, real_fsync = os.open, os.fsync

    def watched_open(path: str | Path, *words: int, **options: int) -> int:
        descriptor = real_open(path, *words, **options)
        opened[descriptor] = os.path.realpath(path)
        return descriptor

    def watched_fsync(descriptor: int) -> None:
        real_fsync(descriptor)
        seen.append(("flush", opened[descriptor]))

    def watch(name: str) -> None:
        real = getattr(os, name)

        def call(old: str | Path, new: str | Path, **options: bool) -> None:
            real(old, new, **options)
            seen.append(("name", str(old), str(new)))

        monkeypatch.setattr(os, name, call)

    monkeypatch.setattr(os, "open", watched_open)
    monkeypatch.setattr(os, "fsync", watched_fsync)
    for name in ("rename", "replace", "link"):
        watch(name)
    return seen


@pytest.mark.parametrize("force", [False, True])
def test_a_file_is_flushed_before_it_gets_its_name_and_its_folder_after(
    tmp_path: Path, events: list[Event], *, force: bool
) -> None:
    path = tmp_path / "a.csv"
    write_file(path, "1", force=force)
    ((_, temporary, named),) = [event for event in events if event[0] == "name"]
    assert named == str(path)
    assert events == [("flush", temporary), ("name", temporary, named), ("flush", str(tmp_path))]


def test_a_folder_is_flushed_as_a_whole_before_it_gets_its_name(tmp_path: Path, events: list[Event]) -> None:
    target = tmp_path / "shoot"
    for force in (False, True):
        (target / "b.txt").unlink(missing_ok=True)  # nobody has told labcal of it
        events.clear()
        with unfinished_folder(target, "render", force=force) as working:
            (working / "images").mkdir()
            write_file(working / "images" / "a.png", "1", force=True)
            (working / "b.txt").write_text("by another program")
        place = events.index(("name", str(working), str(target)))
        flushed = {event[1] for event in events[:place] if event[0] == "flush"}
        # A file that was flushed under another name before it got its own.
        named = {event[2] for event in events[:place] if event[0] == "name" and event[1] in flushed}
        for home, _, files in os.walk(target):
            inside = Path(home).relative_to(target)
            for path in (working / inside, *(working / inside / name for name in files)):
                assert str(path) in flushed | named, path
        assert str(working / "b.txt") in flushed
        assert ("flush", str(tmp_path)) in events[place:]
        for old, new in ((event[1], event[2]) for event in events if event[0] == "name"):
            if Path(old).name.startswith(".labcal-part-"):
                assert ("flush", old) in events[: events.index(("name", old, new))]


def test_what_the_disk_does_not_take_is_told_and_gets_no_name(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    def full(descriptor: int) -> NoReturn:  # noqa: ARG001 - its form
        raise OSError(errno.ENOSPC, "No space left on device")

    (tmp_path / "old.csv").write_text("old")
    monkeypatch.setattr(os, "fsync", full)
    for name in ("new.csv", "old.csv"):
        with pytest.raises(DiskFullError):
            write_file(tmp_path / name, "new", force=True)
    assert [path.name for path in tmp_path.iterdir()] == ["old.csv"]
    assert (tmp_path / "old.csv").read_text() == "old"


def test_folders_that_cannot_be_flushed_are_let_be(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    def refused(number: int) -> None:
        def fsync(descriptor: int) -> NoReturn:  # noqa: ARG001 - its form
            raise OSError(number, os.strerror(number))

        monkeypatch.setattr(os, "fsync", fsync)

    refused(errno.EINVAL)
    flush_folder(tmp_path)
    refused(errno.EIO)
    with pytest.raises(OSError, match="Input/output"):
        flush_folder(tmp_path)
