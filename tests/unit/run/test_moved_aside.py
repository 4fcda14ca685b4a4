"""Folders that are moved aside for their successors, and others that are only called so."""

import errno
import json
from pathlib import Path

import pytest

from labcal.errors import OutputError
from labcal.run.begun import COMMAND, Begun
from labcal.run.foreign import foreign_entries
from labcal.run.made import ASIDE, MADE, provenance_text
from labcal.run.outputs import write_file
from labcal.run.unfinished import unfinished_folder


def made(folder: Path, command: str = "render", *, force: bool = False) -> Path:
    with unfinished_folder(folder, command, force=force) as working:
        write_file(working / "a.txt", command, force=True)
    return folder


def entries(folder: Path) -> list[str]:
    return sorted(path.name for path in folder.iterdir())


def snapshot(folder: Path) -> dict[str, bytes]:
    return {path.name: path.read_bytes() for path in folder.iterdir()}


def refuse(target: Path, said: str) -> None:
    with pytest.raises(OutputError, match=said):
        made(target, force=True)


def test_something_of_the_users_named_like_an_old_folder_stays(tmp_path: Path) -> None:
    target, old = made(tmp_path / "shoot"), tmp_path / "shoot.labcal-old"
    old.mkdir()
    (old / "thesis.txt").write_text("mine")
    refuse(target, "would be kept as .* but that exists")
    assert (old / "thesis.txt").read_text() == "mine"
    target.rename(tmp_path / "elsewhere")
    made(target)
    assert (old / "thesis.txt").read_text() == "mine"


@pytest.mark.parametrize("content", ["nothing", "labcal's", "labcal's, marked for another place"])
def test_a_folder_that_somebody_has_named_like_an_old_one_stays(tmp_path: Path, content: str) -> None:
    target, old = tmp_path / "shoot", tmp_path / "shoot.labcal-old"
    if content == "nothing":
        old.mkdir()
    else:
        made(tmp_path / "mine", "old").rename(old)
    if content.endswith("place"):
        (old / ASIDE).write_text("mine")
    before = snapshot(old)
    made(target)  # nothing was to be replaced
    assert snapshot(old) == before
    (target / COMMAND).write_text(Begun.now("render").text())  # as if it had been killed at the very end
    if content != "nothing":
        made(target, command="render")
    (target / COMMAND).unlink(missing_ok=True)
    refuse(target, "would be kept as .* but that exists")
    assert snapshot(old) == before


def test_an_empty_folder_that_is_replaced_is_put_back_empty(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    target = tmp_path / "shoot"
    target.mkdir()
    rename = Path.rename

    def failing(path: Path, new: Path) -> Path:
        if new == target and path.name == "shoot.unfinished":
            raise OSError(errno.EIO, "Input/output error")
        return rename(path, new)

    monkeypatch.setattr(Path, "rename", failing)
    with pytest.raises(OutputError):
        made(target, force=True)
    monkeypatch.setattr(Path, "rename", rename)
    assert entries(target) == []
    (target / ASIDE).write_text("shoot")  # killed before it was moved
    made(target, force=True)
    assert entries(tmp_path) == ["shoot"]
    assert entries(target) == [MADE, "a.txt"]


def test_times_and_versions_prove_themselves(tmp_path: Path) -> None:
    def run(force: bool) -> Path:  # noqa: FBT001 - a test
        with unfinished_folder(tmp_path / "shoot", "render", force=force) as working:
            write_file(working / "run.json", provenance_text({"seconds": 1.5}), force=True)
        return tmp_path / "shoot" / "run.json"

    path = run(force=False)
    assert json.loads(path.read_text())["seconds"] == 1.5
    assert foreign_entries(path.parent) == []
    run(force=True)
    for changed in (path.read_text().replace("1.5", "2.5"), "{}", ""):
        path.write_text(changed)
        refuse(path.parent, r"run\.json \(changed since labcal wrote it\)")
        assert path.read_text() == changed
