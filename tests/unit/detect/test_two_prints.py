"""Two prints of one board in a picture: neither is taken in silence; another camera may take the other."""

from collections.abc import Callable
from typing import Any

import numpy as np
import pytest

from labcal.bench.boards.april_grid_ink import april_grid_ink
from labcal.bench.boards.charuco_ink import charuco_ink
from labcal.bench.marks.drawn_picture import Exposure, Print, drawn, tilted
from labcal.detect.detector import detect_dots
from labcal.detect.flags import Refusal
from labcal.targets.april_grid import AprilGrid
from labcal.targets.charuco import CharucoBoard, MarkerDictionary

SIZE = (360, 170)
APRIL = AprilGrid(kind="aprilgrid", name="april", tag_cols=2, tag_rows=2, tag_mm=1.5, tag_spacing=0.3)
CHARUCO = CharucoBoard(
    kind="charuco", name="charuco", squares=(4, 4), square_mm=1.0, marker_mm=0.75,
    dictionary=MarkerDictionary.DICT_4X4_50,
)  # fmt: skip


def beside(ink: Print, cut: float, step: float, turn: float) -> Print:
    """Return a print, and once more to the right of a line, a step further and turned."""
    c, s = np.cos(turn), np.sin(turn)

    def both(x: np.ndarray, y: np.ndarray) -> np.ndarray:
        u, v = x - step, y - 1.0
        return np.where(x < cut, ink(x, y), ink(c * u + s * v, 1.0 + c * v - s * u))

    return both


def picture(target: Any, ink: Print, left: float) -> np.ndarray:  # noqa: ANN401 -- two kinds
    """Draw two prints; the left one begins at a pixel."""
    H = tilted(0.2, 0.6, 0.0, 700.0 / 30.0, 700.0)
    x_min, y_min, _, y_max = target.extent_mm
    at = H @ [x_min, (y_min + y_max) / 2, 1.0]
    move = np.array([left, SIZE[1] / 2]) - at[:2] / at[2]
    H = np.array([[1.0, 0, move[0]], [0, 1.0, move[1]], [0, 0, 1.0]]) @ H
    return drawn(Exposure(SIZE, H, 0.7, np.zeros(2), 0.008), ink, (), np.random.default_rng(3))


@pytest.mark.parametrize("turn", [0.0, 0.2])
@pytest.mark.parametrize(
    ("target", "ink", "noun"), [(CHARUCO, charuco_ink, "Markers 0"), (APRIL, april_grid_ink, "Tags 0")]
)
def test_a_board_that_is_seen_twice_is_refused(
    target: Any,  # noqa: ANN401 -- two kinds
    ink: Callable[..., Print],
    noun: str,
    turn: float,
) -> None:
    x_min, _, x_max, _ = target.extent_mm
    step = x_max - x_min + 0.9
    twice = beside(ink(target), x_max + 0.45, step, turn)
    dots = detect_dots(picture(target, twice, 15.0), target)
    assert dots.refusal is Refusal.AMBIGUOUS_MARKERS
    assert dots.why.startswith(noun)
    assert "were read twice, at different places. The board is seen twice. Show one print" in dots.why
    assert not dots.ok.any()
    once = detect_dots(np.ascontiguousarray(picture(target, twice, 15.0)[:, :190]), target)
    assert once.refusal is None
