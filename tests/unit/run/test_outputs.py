import errno
import stat
from pathlib import Path

import pytest

from labcal.errors import DiskFullError, OutputError
from labcal.run.outputs import write_file
from labcal.run.unfinished import unfinished_folder


def entries(folder: Path) -> list[str]:
    return sorted(path.name for path in folder.iterdir())


def mode(path: Path) -> int:
    return stat.S_IMODE(path.stat().st_mode)


def work_until_interrupted(target: Path, command: str) -> None:
    with unfinished_folder(target, command, force=False) as working:
        (working / "a.txt").write_text("1")
        raise KeyboardInterrupt


def test_a_file_is_written_with_the_rights_of_any_other(tmp_path: Path) -> None:
    write_file(tmp_path / "a.txt", "ä\n", force=False)
    (tmp_path / "b.txt").write_text("")
    assert (tmp_path / "a.txt").read_bytes() == "ä\n".encode()
    assert mode(tmp_path / "a.txt") == mode(tmp_path / "b.txt")
    assert entries(tmp_path) == ["a.txt", "b.txt"]


def test_an_existing_file_is_kept_without_force(tmp_path: Path) -> None:
    path = tmp_path / "a.txt"
    path.write_text("old")
    with pytest.raises(OutputError, match="--force"):
        write_file(path, "new", force=False)
    assert path.read_text() == "old"
    write_file(path, "new", force=True)
    assert path.read_text() == "new"


def test_a_folder_that_does_not_exist_is_named(tmp_path: Path) -> None:
    with pytest.raises(OutputError, match="nowhere"):
        write_file(tmp_path / "nowhere" / "a.txt", "x", force=False)


def test_a_file_is_never_replaced_by_half_of_another(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    write = Path.write_bytes

    def full(path: Path, data: bytes) -> int:
        write(path, data[:2])
        raise OSError(errno.ENOSPC, "No space left on device")

    path = tmp_path / "a.txt"
    path.write_text("old")
    monkeypatch.setattr(Path, "write_bytes", full)
    with pytest.raises(DiskFullError, match="disk is full"):
        write_file(path, "something new", force=True)
    assert path.read_text() == "old"
    assert entries(tmp_path) == ["a.txt"]


def test_a_folder_appears_when_the_work_ends_well(tmp_path: Path) -> None:
    target = tmp_path / "out" / "shoot"
    with unfinished_folder(target, "render", force=False) as working:
        (working / "a.txt").write_text("1")
        assert not target.exists()
    assert entries(target) == ["a.txt"]
    assert entries(target.parent) == ["shoot"]


def test_interrupted_work_resumes_where_the_same_command_left_it(tmp_path: Path) -> None:
    target = tmp_path / "shoot"
    with pytest.raises(KeyboardInterrupt):
        work_until_interrupted(target, "render --spp 4")
    assert not target.exists()
    with unfinished_folder(target, "render --spp 4", force=False) as working:
        assert (working / "a.txt").read_text() == "1"
        (working / "b.txt").write_text("2")
    assert entries(target) == ["a.txt", "b.txt"]


def test_what_another_command_left_is_refused_and_discarded_only_with_force(tmp_path: Path) -> None:
    target = tmp_path / "shoot"
    with pytest.raises(KeyboardInterrupt):
        work_until_interrupted(target, "render --spp 4")
    with (
        pytest.raises(OutputError, match="another command"),
        unfinished_folder(target, "render --spp 8", force=False),
    ):
        pass
    assert (tmp_path / "shoot.unfinished" / "a.txt").exists()
    with unfinished_folder(target, "render --spp 8", force=True) as working:
        assert entries(working) == [".command"]


def test_a_run_killed_at_any_moment_goes_on(tmp_path: Path) -> None:
    target, working = tmp_path / "shoot", tmp_path / "shoot.unfinished"
    working.mkdir()  # killed before the folder was marked
    (working / ".command.abc").write_text("ren")  # or while it was
    with pytest.raises(KeyboardInterrupt):
        work_until_interrupted(target, "render")
    (working / "images").mkdir()
    (working / "images" / ".b.png.xyz").write_text("half a picture")
    with unfinished_folder(target, "render", force=False) as again:
        assert sorted(path.name for path in again.rglob("*")) == [".command", "a.txt", "images"]
    assert entries(target) == ["a.txt", "images"]
    (target / ".command").write_text("render")  # killed when all was done but for removing the mark
    with pytest.raises(OutputError, match="--force"), unfinished_folder(target, "other", force=False):
        pass
    with unfinished_folder(target, "render", force=False) as again:
        assert again == working
        assert not target.exists()
    assert entries(target) == ["a.txt", "images"]
    with pytest.raises(OutputError, match="--force"), unfinished_folder(target, "render", force=False):
        pass


def test_an_existing_folder_is_kept_until_its_successor_is_whole(tmp_path: Path) -> None:
    target = tmp_path / "shoot"
    target.mkdir()
    (target / "old.txt").write_text("old")
    with pytest.raises(OutputError, match="--force"), unfinished_folder(target, "render", force=False):
        pass
    with unfinished_folder(target, "render", force=True) as working:
        (working / "new.txt").write_text("new")
        assert entries(target) == ["old.txt"]
    assert entries(target) == ["new.txt"]


def test_a_folder_that_cannot_be_made_is_an_output_error(tmp_path: Path) -> None:
    (tmp_path / "file").write_text("")
    target = tmp_path / "file" / "x"
    with pytest.raises(OutputError, match="file"), unfinished_folder(target, "c", force=False):
        pass


def test_a_full_disk_in_the_work_is_told_as_such(tmp_path: Path) -> None:
    with pytest.raises(DiskFullError), unfinished_folder(tmp_path / "shoot", "c", force=False):
        raise OSError(errno.ENOSPC, "No space left on device")
    assert not (tmp_path / "shoot").exists()
