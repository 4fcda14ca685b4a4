"""The condition that boards side by side can be printed: one sheet holds them all."""

from itertools import combinations

import numpy as np
from jaxtyping import Float64

from labcal.errors import InputError
from labcal.targets.board_set import BoardSet

_FLAT_MM = 1e-6


def require_one_sheet(boards: BoardSet) -> None:
    """Raise where no sheet holds the boards.

    Raises
    ------
    InputError
        They do not lie in one plane, lie on one another, or some are black on white and
        others white on black.
    """
    each = f"each by itself, such as '{boards.names[0]}'"
    corners = []
    for board, T in zip(boards.targets, boards.poses, strict=True):
        if abs(T[2, 3]) > _FLAT_MM or np.abs(T[2, :2]).max() > _FLAT_MM or T[2, 2] < 0.0:
            raise InputError(
                f"The boards of '{boards.name}' do not lie in one plane: '{board.name}' is tilted or lies "
                f"elsewhere. Take {each}, or places in one plane."
            )
        x_min, y_min, x_max, y_max = board.extent_mm
        around = np.array([[x_min, y_min], [x_max, y_min], [x_max, y_max], [x_min, y_max]])
        corners.append(around @ T[:2, :2].T + T[:2, 3])
    for (one, first), (other, second) in combinations(zip(boards.names, corners, strict=True), 2):
        if _overlap(first, second):
            raise InputError(
                f"The boards '{one}' and '{other}' of '{boards.name}' lie on one another. Take {each}, or "
                "places at which their edges do not meet."
            )
    if len({board.is_white_on_black for board in boards.targets}) > 1:
        raise InputError(
            f"Of the boards of '{boards.name}' some are printed black on white and others white on black, "
            f"which no sheet is. Take {each}, or boards of one kind."
        )


def _overlap(one: Float64[np.ndarray, "4 2"], other: Float64[np.ndarray, "4 2"]) -> bool:
    """Tell whether two rectangles overlap: else a side of one of them separates them."""
    for corners in (one, other):
        for side in (corners[1] - corners[0], corners[3] - corners[0]):
            along = side / np.linalg.norm(side)
            low, high = one @ along, other @ along
            if low.max() <= high.min() + _FLAT_MM or high.max() <= low.min() + _FLAT_MM:
                return False
    return True
