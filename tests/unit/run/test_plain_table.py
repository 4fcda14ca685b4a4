"""Plain tables are cut into columns; what is not plain goes the way of the reader of CSV files, alike."""

import csv
import io
import time
from pathlib import Path

import numpy as np
import pytest

from labcal.errors import InputError
from labcal.run.plain_table import plain_columns
from labcal.run.table_columns import table_parts
from labcal.run.tables import columns_text, read_table

HEADER = ("name", "x", "y")


def read(data: bytes) -> list[list[str]] | None:
    found = plain_columns(HEADER, data, 100_000, 2**17)
    if found is None:
        return None
    return [list(line) for columns in found for line in zip(*columns, strict=True)]


@pytest.mark.parametrize(
    "data",
    [
        b"name,x,y\na,1,2\nb,,3\n",
        b"name,x,y\na,1,2\nb,,3",
        b"\xef\xbb\xbfname,x,y\n\xc3\xa4,1,2\n",
        b"name,x,y\n",
        b"name,x,y\n" + b"a name,1.5,-2e-3\n" * 40_000,
    ],
)
def test_lines_are_those_of_the_reader_of_csv_files(data: bytes, tmp_path: Path) -> None:
    path = tmp_path / "table.csv"
    path.write_bytes(data)
    assert read(data) == list(read_table(HEADER, "things", path))


@pytest.mark.parametrize(
    "data",
    [
        b'name,x,y\n"a,b",1,2\n',
        b"name,x,y\n'=a,1,2\n",
        b"name,x,y\r\na,1,2\r\n",
        b"name,x,y\na,1\nb,c,1,2\n",
        b"name,x,y\na,1,2\n\n",
        b"name,x,y\na,1,2,3\n",
        b"name,x,z\na,1,2\n",
        b"name,x,y\n\xff,1,2\n",
        b"name,x,y\n" + b"a" * 2**18 + b",1,2\n",
        b"name,x,y\n" + b"a,1,2\n" * 100_001,
        b"",
    ],
)
def test_what_is_not_plain_or_damaged_is_left_to_it(data: bytes) -> None:
    assert read(data) is None


def test_a_fault_is_named_by_its_line_in_both_ways(tmp_path: Path) -> None:
    """Behind many lines, in a plain table, and in one with an apostrophe in it."""
    for first in ("a,1,2\n", "'=a,1,2\n"):
        path = tmp_path / "table.csv"
        path.write_text("name,x,y\n" + first + "a,1,2\n" * 50_000 + "b,1,two\n" + "c,1,2\n")
        with pytest.raises(InputError, match=r"Line 50003 of .* \(y 'two' is no number\): b,1,two"):  # noqa: PT012
            for part in table_parts(HEADER, "things", path):
                part.figures(("x", "y"))
                part.refuse()


def test_columns_are_written_as_the_writer_of_csv_files_does() -> None:
    names = ["plain", 'a "b"', "a,b", "two\nlines", " space", "", "=1", "ä", "'", "a\\b"]
    figures = [0.1, -1e-300, 1e22, float("nan"), float("inf"), 3.0, -0.0, 1 / 3, 5e-324, 123456789.125]
    for chosen in (names, names[:1] * 10, ["=1", "@", "-2", *["v"] * 7]):
        text = io.StringIO()
        writer = csv.writer(text, lineterminator="\n")
        writer.writerow(HEADER[:2])
        writer.writerows(
            (f"'{name}" if name[:1] in {"=", "@", "-", "'"} and name != "'" else name, figure)
            for name, figure in zip(chosen, figures, strict=True)
        )
        assert columns_text(HEADER[:2], [[chosen, figures]]) == text.getvalue()
        assert columns_text(HEADER[:2], [[chosen, np.array(figures)]]) == text.getvalue()


@pytest.mark.slow
def test_time_grows_with_the_lines(tmp_path: Path) -> None:
    times = []
    for count in (50_000, 200_000):
        path = tmp_path / "table.csv"
        path.write_text("name,x,y\n" + "a,1.25,2.5\n" * count)
        spent = []
        for _ in range(3):
            start = time.process_time()
            for part in table_parts(HEADER, "things", path):
                part.figures(("x", "y"))
            spent.append(time.process_time() - start)
        times.append(min(spent))
    assert times[1] < 8 * times[0]
    assert np.isfinite(times).all()
