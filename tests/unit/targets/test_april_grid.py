"""The description of an AprilGrid: places, Kalibr's order and print, Kalibr's own file."""

from pathlib import Path

import numpy as np
import pytest
from pydantic import ValidationError

from labcal.errors import InputError
from labcal.targets.april_grid import AprilGrid
from labcal.targets.april_grid_outlines import tag_cells
from labcal.targets.catalogue import load_target
from labcal.targets.code_text import code_text, described_by
from labcal.targets.ink_distance import ink_distance

KALIBR = "target_type: 'aprilgrid'\ntagCols: 6\ntagRows: 6\ntagSize: 0.088\ntagSpacing: 0.3\n"
FIRST_TAG = 0xD5D628584
"""Code of tag 0 of 36h11, as the AprilTag project publishes it: the upper left cell is its highest bit."""


def grid(**given: object) -> AprilGrid:
    return AprilGrid.model_validate(
        {"kind": "aprilgrid", "name": "one", "tag_cols": 3, "tag_rows": 2, "tag_mm": 10.0, "tag_spacing": 0.3}
        | given
    )


def test_corners_are_those_of_tags_row_by_row_from_the_lower_left() -> None:
    one = grid()
    places = one.points()[:, :2].reshape(4, 6, 2)
    np.testing.assert_allclose(places[0, :, 0], [0, 10, 13, 23, 26, 36])
    np.testing.assert_allclose(places[:, 0, 1], [0, 10, 13, 23])
    assert one.extent_mm == pytest.approx((-3, -3, 39, 26))


def test_tags_are_printed_as_kalibr_prints_them() -> None:
    cells = tag_cells(grid())[0]
    inner = [[not FIRST_TAG >> (35 - 6 * row - col) & 1 for col in range(6)] for row in range(6)]
    assert cells.shape == (10, 10)
    assert np.array_equal(cells[2:-2, 2:-2], inner)
    assert cells.sum() == 64 + np.sum(inner)


def test_the_print_has_tags_holes_and_squares_at_corners() -> None:
    ink = ink_distance(grid(margin_mm=1.0))

    def is_inked(x: float, y: float) -> bool:
        col = round((x - ink.origin[0]) / ink.step_mm)
        row = round((y - ink.origin[1]) / ink.step_mm)
        return bool(ink.distance[row, col] > 0)

    assert is_inked(-1.5, -1.5)  # a small square
    assert is_inked(11.5, 11.5)
    assert not is_inked(5, -1.5)
    assert not is_inked(11.5, 5)
    assert is_inked(1, 5)  # the border
    inner = [FIRST_TAG >> (35 - k) & 1 for k in range(36)]
    for k, is_white in enumerate(inner):
        row, col = divmod(k, 6)
        assert is_inked(2.5 + col, 7.5 - row) is not bool(is_white)
    assert 13.0 / ink.step_mm == pytest.approx(round(13.0 / ink.step_mm), abs=1e-6)


@pytest.mark.parametrize(
    ("given", "fault"),
    [
        ({"tag_cols": 1, "tag_rows": 1}, "at least two tags"),
        ({"first_id": 585}, "ends at 586"),
        ({"tag_spacing": 0.0}, "tag_spacing"),
    ],
)
def test_what_cannot_be_printed_is_refused(given: dict[str, object], fault: str) -> None:
    with pytest.raises(ValidationError, match=fault):
        grid(**given)


def test_the_code_of_a_print_says_all() -> None:
    one = grid(first_id=7, border_cells=1, margin_mm=2.5)
    found = described_by(code_text(one, 2))
    assert found is not None
    assert found.target == one.model_copy(update={"name": found.target.name})


def test_kalibrs_own_file_is_a_target(tmp_path: Path) -> None:
    file = tmp_path / "april_6x6.yaml"
    file.write_text(KALIBR)
    target = load_target(file)
    assert isinstance(target, AprilGrid)
    assert (target.name, target.tag_cols, target.tag_mm, target.tag_spacing) == ("april-6x6", 6, 88.0, 0.3)
    file.write_text(KALIBR.replace("tagSize: 0.088\n", "tagsize: 0.088\n"))
    with pytest.raises(InputError, match=r"'tagsize' is not known; 'tagSize' is missing"):
        load_target(file)
    file.write_text(KALIBR.replace("0.088", "wide"))
    with pytest.raises(InputError, match="should be a number of metres"):
        load_target(file)
    file.write_text("target_type: 'checkerboard'\ntargetCols: 6\n")
    with pytest.raises(InputError, match="'aprilgrid' is read"):
        load_target(file)


def test_basalts_file_is_a_target_and_a_first_tag_is_kept(tmp_path: Path) -> None:
    file = tmp_path / "aprilgrid_6x6.json"
    file.write_text('{"tagCols": 6, "tagRows": 5, "tagSize": 0.088, "tagSpacing": 0.3}')
    target = load_target(file)
    assert isinstance(target, AprilGrid)
    assert (target.tag_cols, target.tag_rows, target.tag_mm, target.first_id) == (6, 5, 88.0, 0)
    file = tmp_path / "target.yaml"
    file.write_text(f"{KALIBR}codeOffset: 40\n")
    target = load_target(file)
    assert isinstance(target, AprilGrid)
    assert target.first_id == 40


@pytest.mark.parametrize(
    ("size", "spacing", "fault"),
    [
        ("88", "0.3", "0.088 for mm"),
        ("0.088", "0.0264", r"in a unit of length it is 0\.3"),
        ("0.088", "26.4", r"in a unit of length it is 0\.3"),
        ("0.088", "30", "the gap between tags over their size, 0.1 to 1"),
    ],
)
def test_units_that_are_not_kalibrs_are_told(size: str, spacing: str, fault: str, tmp_path: Path) -> None:
    file = tmp_path / "target.yaml"
    file.write_text(KALIBR.replace("0.088", size).replace("tagSpacing: 0.3", f"tagSpacing: {spacing}"))
    with pytest.raises(InputError, match=fault):
        load_target(file)


def test_prints_may_have_no_squares_at_corners() -> None:
    one = grid(corner_squares=False)
    ink = ink_distance(one)
    col, row = (round((11.5 - first) / ink.step_mm) for first in ink.origin)
    assert ink.distance[row, col] < 0.0
    found = described_by(code_text(one, 2))
    assert found is not None
    assert found.target == one.model_copy(update={"name": found.target.name})


@pytest.mark.parametrize(("key", "given"), [("tagRows", "true"), ("tagSpacing", "yes"), ("tagSize", "big")])
def test_numbers_of_kalibr_are_numbers(key: str, given: str, tmp_path: Path) -> None:
    content = {"target_type": "aprilgrid", "tagCols": 6, "tagRows": 6, "tagSize": 0.088, "tagSpacing": 0.3}
    lines = [f"{name}: {given if name == key else value}\n" for name, value in content.items()]
    path = tmp_path / "target.yaml"
    path.write_text("".join(lines))
    with pytest.raises(InputError, match=f"{key}: .* should be"):
        load_target(path)
