"""The table of named pixels: what is written reads back, and what is damaged is refused by its line."""

from pathlib import Path

import numpy as np
import pytest

from labcal import InputError, NamedPixels, read_named_points, read_pixels, write_pixels
from labcal.correspond.named_matching import match_named
from labcal.correspond.named_pixels_csv import is_pixels
from labcal.correspond.named_points import NamedPoints

SHORT = "view,camera,point,x_px,y_px\n"
LONG = "view,camera,point,x_px,y_px,var_xx,var_xy,var_yy\n"


def table(tmp_path: Path, text: str) -> Path:
    path = tmp_path / "pixels.csv"
    path.write_text(text, encoding="utf-8")
    return path


def test_pixels_read_back_exactly(tmp_path: Path) -> None:
    given = NamedPixels(
        ["v 1", "v 1", "=w"],
        ["left", "right", "left"],
        ["corner, upper", "corner, upper", '"=sum'],
        [[0.1, 1 / 3], [np.nan, np.nan], [1e-7, -0.4]],
        [[[0.04, 0.01], [0.01, 0.09]], np.full((2, 2), np.nan), np.full((2, 2), np.nan)],
    )
    write_pixels(tmp_path / "pixels.csv", given)
    assert read_pixels(tmp_path / "pixels.csv") == given
    assert is_pixels(tmp_path / "pixels.csv")


def test_covariances_may_be_left_out_altogether(tmp_path: Path) -> None:
    given = NamedPixels(["v"], ["left"], ["a"], [[1.5, 2.5]])
    write_pixels(tmp_path / "pixels.csv", given)
    assert (tmp_path / "pixels.csv").read_text() == SHORT + "v,left,a,1.5,2.5\n"
    assert read_pixels(tmp_path / "pixels.csv") == given


def test_empty_cells_are_covariances_that_are_not_known(tmp_path: Path) -> None:
    found = read_pixels(table(tmp_path, LONG + "v,left,a,1,2,,,\nv,right,a,1,2,0.01,0,0.01\n"))
    assert found.has_covariance.tolist() == [False, True]


@pytest.mark.parametrize(
    ("text", "why"),
    [
        (SHORT + "v,left,a,1,2\nv,left,b,1,2\nv,left,a,1,2\n", "Line 4 .* same point in a picture as line 2"),
        (SHORT + "v,left,a,1,x\n", "Line 2 .*y_px 'x' is no number"),
        (SHORT + "v,left cam,a,1,2\n", "Line 2 .*letters, digits and hyphens"),
        (SHORT + "v,left,,1,2\n", "Line 2 .*a point's name"),
        (SHORT + "v,left,a,1,nan\n", "Line 2 .*x and y are numbers"),
        (SHORT + "v,left,a,1,1e9\n", "Line 2 .*x and y are numbers"),
        (SHORT + "v,left,a,1\n", "Line 2 .*4 cells, not 5"),
        (LONG + "v,left,a,1,2,0.01,0.02,0.01\n", "Line 2 .*its covariance is none"),
        (LONG + "v,left,a,1,2,0,0,0\n", "Line 2 .*its covariance is none"),
        ("view,camera,name,x_px,y_px\n", "its first line should be view,camera,point,x_px,y_px"),
    ],
)
def test_a_damaged_line_is_named(tmp_path: Path, text: str, why: str) -> None:
    with pytest.raises(InputError, match=why):
        read_pixels(table(tmp_path, text))


def test_a_name_that_could_not_be_read_again_is_not_written(tmp_path: Path) -> None:
    with pytest.raises(InputError, match="The camera 'a b' cannot be written"):
        write_pixels(tmp_path / "pixels.csv", NamedPixels(["v"], ["a b"], ["p"], [[1, 2]]))
    with pytest.raises(InputError, match="The point '' cannot be written"):
        write_pixels(tmp_path / "pixels.csv", NamedPixels(["v"], ["a"], [""], [[1, 2]]))


def test_what_could_not_be_read_again_is_not_written(tmp_path: Path) -> None:
    twice = NamedPixels(["v", "v"], ["a", "a"], ["p", "p"], [[1, 2], [3, 4]])
    far = NamedPixels(["v"], ["a"], ["p"], [[1e9, 2]])
    sharp = NamedPixels(["v"], ["a"], ["p"], [[1, 2]], [1e-30 * np.eye(2)])
    for pixels, why in ((twice, "listed twice"), (far, "is no pixel"), (sharp, "is no pixel")):
        with pytest.raises(InputError, match=why):
            pixels.save(tmp_path / "pixels.csv")
    assert not (tmp_path / "pixels.csv").exists()


def test_points_keep_the_order_in_which_they_appear() -> None:
    pixels = NamedPixels(
        ["b", "a", "b", "a"], ["left", "right", "right", "other"], ["z", "z", "a", "q"], np.ones((4, 2))
    )
    found = match_named(pixels, ("left", "right"))
    assert list(zip(found.view.tolist(), found.name.tolist(), strict=True)) == [
        ("b", "z"), ("a", "z"), ("b", "a"), ("a", "q"),
    ]  # fmt: skip
    assert found.seen.tolist() == [[True, False], [False, True], [False, True], [False, False]]


def test_a_point_that_is_listed_twice_for_a_picture_is_refused() -> None:
    pixels = NamedPixels(["v"] * 3, ["left", "right", "left"], ["a"] * 3, [[1, 2], [3, 4], [5, 6]])
    with pytest.raises(InputError, match="'a' is listed twice for view 'v' of camera 'left'"):
        match_named(pixels, ("left", "right"))


def test_named_points_read_back_exactly(tmp_path: Path) -> None:
    nowhere = np.full((3, 3), np.nan)
    given = NamedPoints(
        ["v", "v"], ["a", "@b"], [[1 / 3, 2, 3], [np.nan] * 3], [np.eye(3) / 7, nowhere],
        ["ok", "too-few-cameras"],
    )  # fmt: skip
    given.save(tmp_path / "points.csv")
    assert read_named_points(tmp_path / "points.csv") == given
    text = (tmp_path / "points.csv").read_text()
    table(tmp_path, text.replace("too-few-cameras", "ok"))
    with pytest.raises(InputError, match=r"Line 3 .*coordinates are numbers"):
        read_named_points(tmp_path / "pixels.csv")


def test_what_is_read_has_the_numbers_of_its_names(tmp_path: Path) -> None:
    """Which the reader hands on, so that nobody looks at a million names again."""
    path = tmp_path / "pixels.csv"
    path.write_text(
        "view,camera,point,x_px,y_px\nw,a,p2,1,2\nv,a,p1,1,2\nw,b,p2,1,2\nv,b,p2,3,4\nw,a,p1,5,6\n"
    )
    read = read_pixels(path)
    again = NamedPixels(read.view, read.camera, read.point, read.position)
    for pixels in (read, read.with_covariances(np.tile(np.eye(2), (5, 1, 1)))):
        np.testing.assert_array_equal(pixels.view_number, again.view_number)
        np.testing.assert_array_equal(pixels.point_number, again.point_number)
    np.testing.assert_array_equal(again.point_number, [0, 1, 0, 0, 1])


def test_a_table_of_another_program_is_told_how_to_become_one(tmp_path: Path) -> None:
    path = table(tmp_path, "scorer,net,net\nbodyparts,tip,tip\ncoords,x,y\n0,1,2\n")
    with pytest.raises(InputError, match=r"is no table of pixels: .*'labcal convert' makes one"):
        read_pixels(path)
