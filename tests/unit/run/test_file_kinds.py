"""Which single files may be replaced: labcal's own, and none that belongs to a folder."""

from pathlib import Path

import numpy as np
import pytest

from labcal.errors import OutputError
from labcal.run import file_kinds
from labcal.run.file_kinds import FileKind, beginning_with, require_no_part, require_replaceable
from labcal.run.file_marks import TEXT_COMMENT
from labcal.run.outputs import write_file
from labcal.run.unfinished import unfinished_folder
from labcal.shoot.pictures import picture_output, png_output, write_picture, write_single_picture

NOTES = FileKind("a file of notes", lambda content: b"note" in content, TEXT_COMMENT)
TABLE = beginning_with("a table", b"view,x\n")


def refuse(path: Path, said: str, kind: FileKind = NOTES) -> None:
    before = path.read_bytes()
    with pytest.raises(OutputError, match=said):
        require_replaceable(path, kind)
    with pytest.raises(OutputError, match=said):
        write_file(path, "note", kind=kind, force=True)
    assert path.read_bytes() == before


def test_a_file_is_replaced_where_it_is_as_labcal_wrote_it(tmp_path: Path) -> None:
    path = tmp_path / "a"
    require_replaceable(path, NOTES)
    for content in ("note 1", "note 2"):
        write_file(path, content, kind=NOTES, force=True)
        assert content.encode() in path.read_bytes()
    assert [entry.name for entry in tmp_path.iterdir()] == ["a"]
    path.write_bytes(path.read_bytes().replace(b"note 2", b"note 3"))
    refuse(path, "changed since labcal wrote it")
    path.write_text("note of mine")
    refuse(path, "no mark of labcal, so another program made it, or an older version")
    path.write_text("a thesis")
    refuse(path, "not a file of notes, but something else")
    path.write_text("")
    write_file(path, "note", kind=NOTES, force=True)
    path.write_text("view,x,remark\n")
    refuse(path, "not a table", TABLE)


def test_a_huge_file_is_not_read(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(file_kinds, "_MOST_BYTES", 100)
    (tmp_path / "a").write_bytes(bytes(101))
    refuse(tmp_path / "a", "too large to be a file of notes of labcal")


def test_parts_of_folders_are_told_by_the_folders_list_and_by_a_manifest(tmp_path: Path) -> None:
    with unfinished_folder(tmp_path / "out", "undistort", force=False) as working:
        (working / "images").mkdir()
        for name in ("rig.json", "images/a.png"):
            write_file(working / name, "note", force=True)
    shoot = tmp_path / "out" / "photos"
    (shoot / "images" / "deep").mkdir(parents=True)
    (shoot / "truth").mkdir()
    for name in ("shoot.json", "images/b.png", "images/deep/c.png", "truth/dots.csv", "mine.csv"):
        (shoot / name).write_text("note")
    (tmp_path / "link").symlink_to("out/images")
    parts = (
        "out/rig.json",
        "out/images/a.png",
        "link/a.png",
        "out/images/../rig.json",
        "out/photos/run.json",
    )
    in_shoot = ("shoot.json", "images/b.png", "images/deep/c.png", "truth/dots.csv")
    for name in (*parts, *(f"out/photos/{one}" for one in in_shoot)):
        with pytest.raises(OutputError, match="belongs to the folder"):
            require_no_part(tmp_path / name)
        with pytest.raises(OutputError, match="belongs to the folder"):
            write_file(tmp_path / name, "note", kind=NOTES, force=True)
    others = (
        "rig.json",
        "out/new.csv",
        "out/images/new.png",
        "out/photos/mine.csv",
        "out/photos/images/new.png",
    )
    for name in (*others, "out/A.PNG"):
        require_no_part(tmp_path / name)
    (tmp_path / "out" / "rig.json").unlink()
    with pytest.raises(OutputError, match="belongs to the folder"):
        require_no_part(tmp_path / "out" / "rig.json")


def test_capitals_matter_only_where_the_disk_says_so(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    with unfinished_folder(tmp_path / "out", "undistort", force=False) as working:
        write_file(working / "rig.json", "note", force=True)
    (tmp_path / "out" / "RIG.json").write_text("another file")
    require_no_part(tmp_path / "out" / "RIG.json")
    monkeypatch.setattr(Path, "samefile", lambda path, other: True)  # noqa: ARG005 - its form
    with pytest.raises(OutputError, match="belongs to the folder"):
        require_no_part(tmp_path / "out" / "RIG.json")


@pytest.mark.parametrize("ending", ["png", "jpg", "tif", "bmp"])
def test_pictures_by_themselves_are_marked_and_parts_of_folders_are_not(tmp_path: Path, ending: str) -> None:
    picture = np.arange(48, dtype=np.uint8).reshape(6, 8)
    single, part = tmp_path / f"single.{ending}", tmp_path / f"part.{ending}"
    write_picture(part, picture)
    for _ in range(2):
        write_single_picture(single, picture, force=True)
    assert b"Made by labcal" in single.read_bytes()
    assert b"labcal" not in part.read_bytes()
    refuse(part, "no mark of labcal, so another program", picture_output(part).kind)


def test_a_png_is_not_named_otherwise(tmp_path: Path) -> None:
    assert png_output(tmp_path / "a.PNG").kind.name == "a PNG picture"
    with pytest.raises(OutputError, match=r"ends in \.png"):
        png_output(tmp_path / "a.jpg")


def test_a_file_that_comes_meanwhile_stays(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    path, write = tmp_path / "a", Path.write_bytes

    def meanwhile(scrap: Path, data: bytes) -> int:
        path.write_text("note of mine")
        return write(scrap, data)

    monkeypatch.setattr(Path, "write_bytes", meanwhile)
    with pytest.raises(OutputError, match="no mark of labcal, so another program"):
        write_file(path, "note", kind=NOTES, force=True)
    assert path.read_text() == "note of mine"
    assert [entry.name for entry in tmp_path.iterdir()] == ["a"]
