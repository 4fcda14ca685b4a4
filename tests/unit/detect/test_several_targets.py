"""The same target twice in one picture, where nothing on it tells the two apart."""

import numpy as np
import pytest

from labcal.bench.boards.chessboard_picture import PLAIN, _ink
from labcal.bench.marks.drawn_picture import Exposure, Print, drawn
from labcal.detect.detector import detect_dots
from labcal.detect.flags import Refusal
from labcal.targets.catalogue import AnyTarget
from labcal.targets.grid import DotGrid

GRID = DotGrid(
    name="six", cols=6, rows=5, pitch_x_mm=20.0, pitch_y_mm=20.0,
    dot_diameter_mm=9.0, rings=None, margin_mm=15.0,
)  # fmt: skip


def dots(x: np.ndarray, y: np.ndarray) -> np.ndarray:
    """Return the ink of the grid."""
    i, j = np.clip(np.round(x / 20.0), 0, 5), np.clip(np.round(y / 20.0), 0, 4)
    return np.asarray(np.hypot(x - 20.0 * i, y - 20.0 * j) < 4.5, dtype=float)


def twice(ink: Print, beside: float, turn: float) -> Print:
    """Return a print with a second one beside it, turned."""
    c, s = np.cos(turn), np.sin(turn)

    def both(x: np.ndarray, y: np.ndarray) -> np.ndarray:
        u, v = x - beside, y
        return np.maximum(ink(x, y), ink(c * u + s * v, c * v - s * u))

    return both


@pytest.mark.parametrize(
    ("target", "ink", "px_a_unit"),
    [(PLAIN, _ink(PLAIN), 18.0 / PLAIN.square_mm), (GRID, dots, 1.2)],
    ids=["chessboard", "grid"],
)
def test_a_target_that_is_there_twice_is_refused_as_that(
    target: AnyTarget, ink: Print, px_a_unit: float
) -> None:
    x = target.points()[:, :2]
    wide = float(np.ptp(x[:, 0]))
    scale = np.diag([px_a_unit, -px_a_unit, 1.0])
    H = np.array([[1.0, 0.0, 60.0], [0.0, 1.0, 250.0], [0.0, 0.0, 1.0]]) @ scale
    size = (int(3.3 * wide * px_a_unit + 160), 330)
    how = Exposure(size, H, 0.8, np.zeros(2), 0.01)
    random = np.random.default_rng(1)
    alone = detect_dots(drawn(how, ink, (), random), target)
    assert alone.refusal is None
    found = detect_dots(drawn(how, twice(ink, 2.1 * wide, 0.4), (), random), target)
    assert found.refusal is Refusal.SEVERAL_TARGETS
