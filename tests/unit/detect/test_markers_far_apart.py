"""Markers that are right, and too far from each other to predict one another, place a board."""

import numpy as np
import pytest

from labcal.detect.corners.marker_places import _on_board, markers_in_place
from labcal.detect.corners.seen_markers import SeenMarkers
from labcal.detect.settings import DEFAULTS
from labcal.targets.charuco import CharucoBoard, MarkerDictionary

BOARD = CharucoBoard(
    kind="charuco", name="charuco", squares=(9, 7), square_mm=1.0, marker_mm=0.75,
    dictionary=MarkerDictionary.DICT_4X4_50,
)  # fmt: skip
FEW = np.array([1, 10, 16, 17, 21, 29, 30])
"""As OpenCV read them in a blurred picture."""


def seen(shown: CharucoBoard, numbers: np.ndarray, seed: int) -> SeenMarkers:
    """Return markers of a board as a camera sees them, their corners off by a tenth of a square."""
    H = np.array([[20.0, -12.0, 150.0], [-14.0, -22.0, 250.0], [0.004, 0.01, 1.0]])
    squares = _on_board(shown)[numbers].reshape(-1, 2)
    xyw = np.column_stack([squares, np.ones(len(squares))]) @ H.T
    q = xyw[:, :2] / xyw[:, 2:] + np.random.default_rng(seed).uniform(-1.6, 1.6, (len(squares), 2))
    return SeenMarkers(numbers, q.reshape(-1, 4, 2))


@pytest.mark.parametrize("seed", range(8))
def test_one_homography_takes_markers_to_their_places(seed: int) -> None:
    placed = markers_in_place(seen(BOARD, FEW, seed), BOARD, DEFAULTS.corner)
    assert len(placed.number) >= 4
    assert set(placed.number) <= set(FEW)


@pytest.mark.parametrize("squares", [(8, 7), (10, 7), (7, 9), (11, 7)])
@pytest.mark.parametrize("seed", range(3))
def test_markers_of_a_board_of_other_squares_are_not_in_place(squares: tuple[int, int], seed: int) -> None:
    shown = BOARD.model_copy(update={"squares": squares})
    numbers = FEW[shown.marker_count > FEW]
    placed = markers_in_place(seen(shown, numbers, seed), BOARD, DEFAULTS.corner)
    assert len(placed.number) == 0
