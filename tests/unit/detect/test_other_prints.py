"""AprilGrids of another border or set of tags than the target says: the refusal names what the print has."""

from typing import Any

import numpy as np
import pytest

from labcal.bench.boards.april_grid_ink import april_grid_ink
from labcal.bench.marks.drawn_picture import Exposure, drawn, tilted
from labcal.detect.corners.markers_elsewhere import why_not_in_place
from labcal.detect.corners.seen_markers import SeenMarkers
from labcal.detect.corners.tag_codes import SeenTags
from labcal.detect.corners.tags_elsewhere import why_no_tags
from labcal.detect.detector import detect_dots
from labcal.detect.flags import Refusal
from labcal.detect.settings import DEFAULTS
from labcal.targets.april_grid import AprilGrid
from labcal.targets.catalogue import load_target
from labcal.targets.charuco import CharucoBoard, MarkerDictionary

SIZE = (240, 170)
GRID = AprilGrid(kind="aprilgrid", name="target", tag_cols=3, tag_rows=2, tag_mm=1.0, tag_spacing=0.5)
EMPTY = np.full((60, 80), 90, dtype=np.float32)
ONE_QUAD = np.array([[[10.0, 40.0], [40.0, 40.0], [40.0, 10.0], [10.0, 10.0]]])


def picture(**other: Any) -> np.ndarray:  # noqa: ANN401 -- keys of a target
    """Draw a print that is as the target but for some keys."""
    shown = GRID.model_copy(update=other)
    H = tilted(0.3, 0.6, 0.15, 700.0 / 42.0, 700.0)
    x_min, y_min, x_max, y_max = shown.extent_mm
    middle = H @ [(x_min + x_max) / 2, (y_min + y_max) / 2, 1.0]
    move = np.array(SIZE) / 2 - middle[:2] / middle[2]
    H = np.array([[1.0, 0, move[0]], [0, 1.0, move[1]], [0, 0, 1.0]]) @ H
    how = Exposure(SIZE, H, 0.7, np.zeros(2), 0.008)
    return drawn(how, april_grid_ink(shown), (), np.random.default_rng(3))


@pytest.mark.parametrize("squares", [True, False])
@pytest.mark.parametrize(("printed", "stated"), [(1, 2), (2, 1)])
def test_a_border_that_is_stated_wrongly_is_named(printed: int, stated: int, *, squares: bool) -> None:
    grid = GRID.model_copy(update={"border_cells": stated, "corner_squares": squares})
    dots = detect_dots(picture(border_cells=printed, corner_squares=squares), grid)
    assert dots.refusal is Refusal.BORDER_CELLS
    assert f"6 tags of DICT_APRILTAG_36h11 with border_cells: {printed} are in place." in dots.why
    assert "Set `border_cells:` in the target" in dots.why


@pytest.mark.parametrize("border", [1, 2])
def test_another_set_of_tags_is_named(border: int) -> None:
    shown = {"dictionary": MarkerDictionary.DICT_APRILTAG_16H5, "border_cells": border}
    dots = detect_dots(picture(**shown), GRID)
    assert dots.refusal is Refusal.NO_MARKERS
    assert "6 tags of DICT_APRILTAG_16h5 are in place" in dots.why
    assert ("with border_cells: 1" in dots.why) == (border == 1)
    assert "; the target has DICT_APRILTAG_36h11." in dots.why


def test_a_single_tag_or_marker_of_no_board_is_no_evidence() -> None:
    refusal, detail = why_no_tags(EMPTY, SeenTags(np.array([501]), ONE_QUAD), GRID, DEFAULTS)
    assert refusal is Refusal.NO_MARKERS
    assert "Tag 501 of DICT_APRILTAG_36h11 was read; the target has 0 to 5. One tag alone" in detail
    board = load_target("charuco-12x9")
    assert isinstance(board, CharucoBoard)
    refusal, detail = why_not_in_place(SeenMarkers(np.array([99]), ONE_QUAD), board, DEFAULTS.corner)
    assert refusal is Refusal.NO_MARKERS
    assert "One marker alone" in detail


def test_two_tags_of_other_ids_are_told() -> None:
    seen = SeenTags(np.array([501, 502]), np.concatenate([ONE_QUAD, ONE_QUAD + 40.0]))
    assert why_no_tags(EMPTY, seen, GRID, DEFAULTS)[0] is Refusal.OTHER_IDS
