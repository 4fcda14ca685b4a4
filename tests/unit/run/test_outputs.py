import errno
import os
import stat
from pathlib import Path
from typing import NoReturn

import pytest

from labcal.errors import DiskFullError, OutputError
from labcal.run.outputs import appearing_file, write_file


def entries(folder: Path) -> list[str]:
    return sorted(path.name for path in folder.iterdir())


def mode(path: Path) -> int:
    return stat.S_IMODE(path.stat().st_mode)


def test_a_file_is_written_with_the_rights_of_any_other(tmp_path: Path) -> None:
    write_file(tmp_path / "a.txt", "ä\n", force=False)
    (tmp_path / "b.txt").write_text("")
    assert (tmp_path / "a.txt").read_bytes() == "ä\n".encode()
    assert mode(tmp_path / "a.txt") == mode(tmp_path / "b.txt")
    assert entries(tmp_path) == ["a.txt", "b.txt"]


def test_an_existing_file_is_kept_without_force(tmp_path: Path) -> None:
    path = tmp_path / "a.txt"
    path.write_text("old")
    with pytest.raises(OutputError, match="`force=True`"):
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


def test_a_file_that_appears_meanwhile_is_not_replaced_unasked(tmp_path: Path) -> None:
    path = tmp_path / "a.txt"

    def write() -> None:
        with appearing_file(path, force=False) as temporary:
            assert temporary.name.startswith(".labcal-")  # so that everybody knows whose it is
            temporary.write_text("labcal's")
            path.write_text("mine")

    for _ in range(2):
        path.unlink(missing_ok=True)
        with pytest.raises(OutputError, match="exists already"):
            write()
        assert path.read_text() == "mine"
    assert entries(tmp_path) == ["a.txt"]


def test_a_disk_without_links_takes_files_all_the_same(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    def refused(old: Path, new: Path) -> NoReturn:  # noqa: ARG001 - its form
        raise OSError(errno.EPERM, "Operation not permitted")

    monkeypatch.setattr(os, "link", refused)
    write_file(tmp_path / "a.txt", "1", force=False)
    assert entries(tmp_path) == ["a.txt"]
    with pytest.raises(OutputError, match="exists already"):
        write_file(tmp_path / "a.txt", "2", force=False)


@pytest.mark.parametrize("to", ["mine.txt", "nowhere"])
def test_nothing_is_written_through_a_link(tmp_path: Path, to: str) -> None:
    (tmp_path / "mine.txt").write_text("mine")
    (tmp_path / "link.txt").symlink_to(to)
    for force in (False, True):
        with pytest.raises(OutputError, match="A link is not replaced"):
            write_file(tmp_path / "link.txt", "new", force=force)
    assert (tmp_path / "link.txt").is_symlink()
    assert (tmp_path / "mine.txt").read_text() == "mine"
    assert entries(tmp_path) == ["link.txt", "mine.txt"]
