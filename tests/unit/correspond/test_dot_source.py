"""Tables of dots beside other files that may be given where pictures are."""

from pathlib import Path

import pytest

from labcal import examples, read_detections
from labcal.correspond.dot_source import is_dot_table
from labcal.correspond.sources import loose_sources
from labcal.errors import InputError


def test_lists_and_pictures_without_a_header_are_no_tables(tmp_path: Path) -> None:
    table = tmp_path / "dots.csv"
    examples.detections().save(table)
    for name, content, expected in (
        ("a.txt", b"one.png\ntwo.png\n", False),
        ("b.TXT", table.read_bytes(), True),
        ("c.raw", bytes(12), False),
        ("d.png", table.read_bytes(), False),
        ("e.dat", b"anything", True),
    ):
        (tmp_path / name).write_bytes(content)
        assert is_dot_table(tmp_path / name) is expected, name
    assert is_dot_table(table)
    assert not is_dot_table(tmp_path)


def test_corners_in_place_of_a_table_are_named(tmp_path: Path) -> None:
    path = tmp_path / "corners.vnl"
    path.write_text("# filename x y level\na.png 1 2 0\n")
    with pytest.raises(InputError, match=r"may be a corners\.vnl.*labcal convert"):
        read_detections(path)


def test_a_folder_above_those_of_pictures_names_one_of_them(tmp_path: Path) -> None:
    for camera in ("cam0", "cam1"):
        home = tmp_path / "day" / "a" / "b" / "session" / camera / "data"
        home.mkdir(parents=True)
        (home / "0.png").touch()
    with pytest.raises(InputError, match=r"but there are in .*day/a\. Give that folder"):
        loose_sources([str(tmp_path / "day" / ".." / "day")], {})
    (tmp_path / "empty" / "inner").mkdir(parents=True)
    with pytest.raises(InputError, match="no file is there"):
        loose_sources([str(tmp_path / "empty")], {})
