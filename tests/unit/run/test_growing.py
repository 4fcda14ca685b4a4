import os
from pathlib import Path

import pytest

from labcal.errors import OutputError
from labcal.run.begun import COMMAND
from labcal.run.growing import growing_folder
from labcal.run.made import MADE
from labcal.run.outputs import write_file


@pytest.fixture(autouse=True)
def quick_disk(monkeypatch: pytest.MonkeyPatch) -> None:
    """Wait for no disk: ``test_durable.py`` looks at that."""
    monkeypatch.setattr(os, "fsync", lambda descriptor: None)  # noqa: ARG005 - its form


def grown(
    place: Path, parts: int, command: str = "capture", *, fails: bool = False, force: bool = False
) -> None:
    """Write parts that are not there yet; end badly where asked to."""
    with growing_folder(place, command, force=force) as folder:
        for part in range(parts):
            if not (folder.path / str(part)).exists():
                write_file(folder.path / str(part), f"{command} {part}", force=True)
                folder.show()
        if fails:
            raise KeyboardInterrupt


def names(folder: Path) -> list[str]:
    return sorted(path.name for path in folder.iterdir() if not path.name.startswith(".labcal"))


def test_the_folder_is_in_its_place_from_the_first_part_on(tmp_path: Path) -> None:
    place = tmp_path / "shoot"
    with growing_folder(place, "capture", force=False) as folder:
        write_file(folder.path / "0", "0", force=True)
        assert not place.exists()
        folder.show()
        assert names(place) == ["0"]
        write_file(folder.path / "1", "1", force=True)
        assert names(place) == ["0", "1"]
    assert (place / MADE).exists()
    assert not (place / COMMAND).exists()
    assert names(tmp_path) == ["shoot"]


def test_what_was_shown_stays_and_the_same_command_goes_on(tmp_path: Path) -> None:
    place = tmp_path / "shoot"
    with pytest.raises(KeyboardInterrupt):
        grown(place, 2, fails=True)
    assert names(place) == ["0", "1"]
    with pytest.raises(OutputError, match="another command"):
        grown(place, 3, "other")
    grown(place, 3)
    assert names(place) == ["0", "1", "2"]
    assert (place / MADE).exists()


def test_a_finished_folder_is_replaced_on_request_only_and_when_the_first_part_is_there(
    tmp_path: Path,
) -> None:
    place = tmp_path / "shoot"
    grown(place, 2)
    with pytest.raises(OutputError, match="exists"):
        grown(place, 1, "again")
    with (
        pytest.raises(KeyboardInterrupt),
        growing_folder(place, "again", force=True),
    ):
        raise KeyboardInterrupt  # before anything was taken
    assert names(place) == ["0", "1"]
    grown(place, 1, "again", force=True)
    assert (place / "0").read_text() == "again 0"
    assert names(place) == ["0"]
    assert names(tmp_path) == ["shoot"]


def test_an_unfinished_folder_of_another_command_is_discarded_on_request_only(tmp_path: Path) -> None:
    place = tmp_path / "shoot"
    with pytest.raises(KeyboardInterrupt):
        grown(place, 2, fails=True)
    (place / "mine").touch()
    with pytest.raises(OutputError, match="mine"):
        grown(place, 1, "other", force=True)
    (place / "mine").unlink()
    grown(place, 1, "other", force=True)
    assert (place / "0").read_text() == "other 0"
