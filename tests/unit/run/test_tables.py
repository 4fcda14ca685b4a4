from pathlib import Path

import pytest

from labcal.errors import InputError
from labcal.run import tables
from labcal.run.tables import damaged_line, read_table, table_text

HEADER = ("name", "x_px")


def test_floats_read_back_exactly(tmp_path: Path) -> None:
    path = tmp_path / "a.csv"
    path.write_text(table_text(HEADER, [["a,b", 0.1 + 0.2], ["c", float("nan")], ["d", 7]]))
    lines = list(read_table(HEADER, "things", path))
    assert lines == [["a,b", "0.30000000000000004"], ["c", "nan"], ["d", "7"]]
    assert float(lines[0][1]) == 0.1 + 0.2


@pytest.mark.parametrize(
    ("content", "says"),
    [
        (b"", "its first line should be name,x_px"),
        (b"name,y_px\n", "is no table of things"),
        (b"\xff\xfe\x00", "things .*cannot be read"),
    ],
)
def test_what_is_no_such_table_is_refused(tmp_path: Path, content: bytes, says: str) -> None:
    path = tmp_path / "a.csv"
    path.write_bytes(content)
    with pytest.raises(InputError, match=says):
        list(read_table(HEADER, "things", path))


def test_a_missing_file_is_named(tmp_path: Path) -> None:
    with pytest.raises(InputError, match=r"The things .*none\.csv cannot be read: No such file"):
        list(read_table(HEADER, "things", tmp_path / "none.csv"))


def test_lines_are_counted_as_an_editor_does() -> None:
    assert "Line 2 of a.csv is damaged: x,y" in str(damaged_line(Path("a.csv"), 0, ["x", "y"]))


def test_a_bad_line_is_come_to_after_the_good_ones(tmp_path: Path) -> None:
    path = tmp_path / "a.csv"
    path.write_text("name,x_px\na,1\nb,2,3\n")
    lines = read_table(HEADER, "things", path)
    assert next(lines) == ["a", "1"]
    with pytest.raises(InputError, match=r"Line 3 of .* is damaged \(it has 3 cells, not 2\): b,2,3"):
        next(lines)


def test_a_table_has_an_end(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(tables, "MOST_LINES", 2)
    path = tmp_path / "a.csv"
    path.write_text("name,x_px\n" + "a,1\n" * 3)
    with pytest.raises(InputError, match=r"more than 2 lines\. Split the table by views"):
        list(read_table(HEADER, "things", path))


def test_a_quotation_mark_that_is_never_closed_is_told_with_its_line(tmp_path: Path) -> None:
    path = tmp_path / "a.csv"
    path.write_text('name,x_px\na,1\n"b,2\nc,3\n')
    with pytest.raises(InputError, match=r"things .*a\.csv cannot be read: line 3: unexpected end of data"):
        list(read_table(HEADER, "things", path))
