"""points.csv: written and read back exactly, and damaged in every way."""

from dataclasses import fields
from pathlib import Path

import numpy as np
import pytest

from labcal.correspond.points import Points
from labcal.correspond.points_csv import points_csv, read_points
from labcal.errors import InputError

HEADER = "view,col,row,X_mm,Y_mm,Z_mm,cov_xx,cov_xy,cov_xz,cov_yy,cov_yz,cov_zz,flag"
LINE = "a,1,2,10.5,20.25,-30.0,9.0,2.0,3.0,8.0,5.0,7.0,ok"


def table(n: int = 20) -> Points:
    rng = np.random.default_rng(1)
    root = rng.normal(size=(n, 3, 3)) / 3
    covariance = root @ np.swapaxes(root, 1, 2)
    covariance = (covariance + np.swapaxes(covariance, 1, 2)) / 2
    point = rng.normal(size=(n, 3)) * 1e3
    flag = np.array(["ok", "extrapolated", "no-solution", "ok"] * (n // 4))
    point[flag == "no-solution"] = np.nan
    covariance[flag == "no-solution"] = np.nan
    index = np.stack(np.divmod(np.arange(n), 5), axis=1)
    return Points(np.array(["pose-1", "pose-2"] * (n // 2)), index, point, covariance, flag)


def test_a_table_reads_back_exactly(tmp_path: Path) -> None:
    text = points_csv(table())
    assert text.splitlines()[0] == HEADER
    (tmp_path / "p.csv").write_text(text)
    back = read_points(tmp_path / "p.csv")
    for field in fields(Points):
        np.testing.assert_array_equal(getattr(back, field.name), getattr(table(), field.name))
    assert points_csv(back) == text


def test_the_covariance_is_symmetric_in_the_order_of_the_header(tmp_path: Path) -> None:
    (tmp_path / "p.csv").write_text(f"{HEADER}\n{LINE}\n")
    back = read_points(tmp_path / "p.csv")
    assert back.covariance[0].tolist() == [[9, 2, 3], [2, 8, 5], [3, 5, 7]]
    assert back.point[0].tolist() == [10.5, 20.25, -30.0]
    assert back.index[0].tolist() == [1, 2]


@pytest.mark.parametrize(
    "line",
    [
        "",
        "a,1,2,5.0,ok",  # one figure must not stand for nine
        LINE.removesuffix(",ok"),
        LINE + ",ok",
        LINE.replace(",ok", ",fine"),
        LINE.replace("10.5", "ten"),
        LINE.replace("a,1,", "a,1.5,"),
        LINE.replace("a,1,", "a,99999999999999999999,"),
        LINE.replace("-30.0", "1e200"),
        LINE.replace("-30.0", "nan"),
        LINE.replace("-30.0", "-inf"),
        LINE.replace("9.0", "-9.0").replace("a,1,", "a,2,"),
        LINE.replace("9.0", "1e300").replace("a,1,", "a,2,"),
        LINE.replace("a,1,", "\x1b[2J,1,"),
    ],
)
def test_a_damaged_line_is_named(tmp_path: Path, line: str) -> None:
    (tmp_path / "p.csv").write_text(f"{HEADER}\n{LINE}\n{line}\n{LINE}\n")
    with pytest.raises(InputError, match=r"Line 3 of .*p\.csv is damaged"):
        read_points(tmp_path / "p.csv")


def test_other_files_are_refused(tmp_path: Path) -> None:
    (tmp_path / "p.csv").write_text("X,Y,Z\n1,2,3\n")
    with pytest.raises(InputError, match="is no table of points: its first line should be view,col"):
        read_points(tmp_path / "p.csv")
    for path in (tmp_path, tmp_path / "none.csv"):
        with pytest.raises(InputError, match="cannot be read"):
            read_points(path)


def test_a_dot_is_listed_once_for_a_view(tmp_path: Path) -> None:
    (tmp_path / "p.csv").write_text(f"{HEADER}\n{LINE}\n{LINE.replace('10.5', '11.5')}\n")
    with pytest.raises(InputError, match=r"Line 3 of .* is of the same dot of a view as line 2"):
        read_points(tmp_path / "p.csv")


@pytest.mark.parametrize(
    ("line", "why"),
    [
        (LINE.removesuffix(",ok"), "it has 12 cells, not 13"),
        (LINE.replace(",ok", ",fine"), "its flag should be one of "),
        (LINE.replace("10.5", "ten"), "X_mm 'ten' is no number"),
        (LINE.replace("a,1,", "a,1.5,"), "col '1.5' is no whole number"),
        (LINE.replace("a,1,", "a,20000,"), "col and row are at most 10000"),
        (LINE.replace("-30.0", "1e200"), "coordinates are numbers of at most 1e+09 mm"),
        (LINE.replace("9.0", "-9.0"), "its covariance is none"),
        (LINE.replace("a,1,", "\x1b[2J,1,"), "control characters"),
    ],
)
def test_a_damaged_line_says_why(tmp_path: Path, line: str, why: str) -> None:
    (tmp_path / "p.csv").write_text(f"{HEADER}\n{LINE.replace('a,1', 'a,2')}\n{line}\nand,so,on\n")
    with pytest.raises(InputError) as caught:
        read_points(tmp_path / "p.csv")
    assert str(caught.value).startswith(f"Line 3 of {tmp_path}")
    assert why in str(caught.value)
