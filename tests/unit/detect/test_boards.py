"""Several boards in one picture: each found by its own ids or size, none taken for another."""

import cv2
import numpy as np
import pytest

from labcal.bench.marks.drawn_picture import Exposure, drawn
from labcal.correspond.gathering import gather
from labcal.correspond.sources import Source
from labcal.detect.detector import detect_dots
from labcal.detect.dots import PictureDots
from labcal.errors import InputError
from labcal.report.overlay import draw_overlay
from labcal.rng import generator
from labcal.targets.board_set import BoardSet
from labcal.targets.shapes import printed_outlines
from labcal.targets.target import PrintableTarget

SIZE = (420, 230)
RASTER = 16
"""Pixels a mm of the drawing of the print."""
CHARUCO = {
    "kind": "charuco",
    "squares": (6, 5),
    "square_mm": 8.0,
    "marker_mm": 6.0,
    "dictionary": "DICT_4X4_100",
}
TAGS = {"kind": "aprilgrid", "tag_cols": 3, "tag_rows": 3, "tag_mm": 10.0, "tag_spacing": 0.3}
CHESS = {"kind": "chessboard", "cols": 6, "rows": 5, "square_mm": 8.0}
DOTS = {
    "cols": 8,
    "rows": 7,
    "pitch_x_mm": 6.0,
    "pitch_y_mm": 6.0,
    "dot_diameter_mm": 3.0,
    "ring_outer_diameter_mm": 4.5,
    "ring_inner_diameter_mm": 2.0,
    "polarity": "black-on-white",
    "margin_mm": 6.0,
    "rings": {"origin": (2, 2), "x": (5, 2), "y": (2, 4)},
}


def boards(*targets: dict[str, object]) -> BoardSet:
    named = tuple({**one, "name": f"board-{number}"} for number, one in enumerate(targets))
    return BoardSet(name="plate", targets=named)


def picture(target: PrintableTarget, seed: int = 1) -> tuple[np.ndarray, Exposure]:
    """Return a picture of all that is printed, slightly aslant, and how it was taken."""
    x_min, y_min, x_max, y_max = target.extent_mm
    scale = 0.88 * min(SIZE[0] / (x_max - x_min), SIZE[1] / (y_max - y_min))
    middle = [0.5 * (x_min + x_max), 0.5 * (y_min + y_max)]
    aslant = np.array([[1.0, 0.02, 0.0], [-0.03, -1.0, 0.0], [2e-4, 1e-4, 1.0]])
    H = np.array([[scale, 0, SIZE[0] / 2], [0, scale, SIZE[1] / 2], [0, 0, 1.0]]) @ aslant
    H = H @ np.array([[1.0, 0, -middle[0]], [0, 1.0, -middle[1]], [0, 0, 1.0]])
    exposure = Exposure(SIZE, H, 0.7, np.zeros(2), 0.01)
    raster = np.zeros((int(RASTER * (y_max - y_min)), int(RASTER * (x_max - x_min))), dtype=np.uint8)
    for shape in printed_outlines(target).to_polygons():
        one = np.zeros_like(raster)
        cv2.fillPoly(one, [np.round((shape - [x_min, y_min]) * RASTER * 16 - 8).astype(np.int32)], 1, shift=4)
        raster ^= one

    def ink(x: np.ndarray, y: np.ndarray) -> np.ndarray:
        across, up = ((x - x_min) * RASTER - 0.5, (y - y_min) * RASTER - 0.5)
        shade = cv2.remap(255 * raster, across.astype(np.float32), up.astype(np.float32), cv2.INTER_LINEAR)
        return np.asarray(shade / 255.0)

    return drawn(exposure, ink, (), generator(seed, "boards")), exposure


def off_by(found: PictureDots, target: BoardSet, exposure: Exposure) -> np.ndarray:
    ok = found.ok
    return np.asarray(found.position[ok] - exposure.seen(target.points(found.index[ok])[:, :2]))


@pytest.mark.parametrize(
    "target",
    [
        boards(CHARUCO, {**CHARUCO, "first_id": 50}),
        boards(TAGS, {**TAGS, "first_id": 20}),
        boards(CHARUCO, DOTS),
        boards(CHESS, CHARUCO),
    ],
    ids=["charuco beside charuco", "tags beside tags", "charuco beside dots", "chessboard beside charuco"],
)
def test_every_dot_is_its_own_boards(target: BoardSet) -> None:
    image, exposure = picture(target)
    found = detect_dots(image, target)
    assert found.refusal is None
    counts = np.bincount(target.board_number[found.index[found.ok, 0]], minlength=2)
    assert (counts >= 0.9 * np.array([board.count for board in target.targets])).all()
    assert np.abs(off_by(found, target, exposure)).max() < 0.3
    table = gather([Source("v", "camera", "v.png", None)], [found])
    assert table.boards == target.names
    first = table.where(table.board == "board-1").index[0]
    assert tuple(first.tolist()) == (0, 0)
    assert draw_overlay(image, found, target).shape == (*image.shape, 3)


def test_a_board_out_of_sight_is_no_fault() -> None:
    pair = boards(CHARUCO, {**CHARUCO, "first_id": 50})
    image, _ = picture(pair.targets[1])
    found = detect_dots(image, pair)
    assert found.refusal is None
    assert set(gather([Source("v", "camera", "v.png", None)], [found]).boards) == {"board-1"}


def test_a_picture_without_any_board_says_so_of_each() -> None:
    pair = boards(CHARUCO, {**CHARUCO, "first_id": 50})
    found = detect_dots(np.full((200, 300), 128, dtype=np.uint8), pair)
    assert found.refusal is not None
    assert "'board-0': no-markers, 'board-1': no-markers" in found.why


@pytest.mark.parametrize(
    ("targets", "why"),
    [
        ((CHARUCO, CHARUCO), "both have markers of DICT_4X4 0 to 14"),
        ((CHARUCO, {**CHARUCO, "dictionary": "DICT_4X4_50"}), "both have markers of DICT_4X4 0 to 14"),
        ((CHESS, CHESS), "both have 6 x 5 corners"),
        ((DOTS, DOTS), "rings are at the same distances"),
        ((CHARUCO, {**CHESS, "cols": 5}), "looks the same when turned"),
    ],
)
def test_boards_that_look_alike_are_refused(targets: tuple[dict[str, object], ...], why: str) -> None:
    with pytest.raises(ValueError, match=why):
        boards(*targets)


def test_a_set_names_each_board_once() -> None:
    with pytest.raises(ValueError, match="need names that differ"):
        BoardSet(name="plate", targets=({**CHARUCO, "name": "a"}, {**TAGS, "name": "a"}))
    assert issubclass(InputError, ValueError)
