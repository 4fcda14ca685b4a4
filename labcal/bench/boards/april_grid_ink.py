"""The print of an AprilGrid as a function of the place on it, to draw pictures from."""

import numpy as np

from labcal.bench.marks.drawn_picture import Print
from labcal.targets.april_grid import AprilGrid
from labcal.targets.april_grid_outlines import tag_cells

PAPER_CELLS = 3
"""White paper around the print."""
_ROUNDING = 1e-9
"""Of a number of cells."""
_BEYOND = 0.6
"""Share of ink of what lies behind the paper."""


def april_grid_ink(grid: AprilGrid) -> Print:
    """Return the share of ink at places of a print, mm in the target's frame.

    An edge is linear across a sample: along the rows of samples it would else be off by up to half of one.

    Parameters
    ----------
    grid : AprilGrid
        The space between its tags is a whole number of cells.

    Raises
    ------
    ValueError
        It is not.
    """
    black = tag_cells(grid)
    cells = black.shape[1]
    gap = round(cells * grid.tag_spacing)
    if not np.isclose(gap, cells * grid.tag_spacing, rtol=0.0, atol=_ROUNDING):
        raise ValueError("the space between tags should be a whole number of cells")
    pitch, rim = cells + gap, gap + PAPER_CELLS
    shape = (grid.tag_rows * pitch + gap + 2 * PAPER_CELLS, grid.tag_cols * pitch + gap + 2 * PAPER_CELLS)
    whole = np.zeros(shape)  # row 0 is the lowest
    for number, tag in enumerate(black):
        row, col = divmod(number, grid.tag_cols)
        y, x = rim + pitch * row, rim + pitch * col
        whole[y : y + cells, x : x + cells] = tag[::-1]
    for row in range(grid.tag_rows + 1):
        for col in range(grid.tag_cols + 1):
            y, x = PAPER_CELLS + pitch * row, PAPER_CELLS + pitch * col
            whole[y : y + gap, x : x + gap] = 1.0
    whole = np.pad(whole, 1, constant_values=_BEYOND)

    def ink(x: np.ndarray, y: np.ndarray) -> np.ndarray:
        value = np.zeros(np.shape(x))
        (left, right_share), (below, upper_share) = (
            _beside(np.nan_to_num(place, nan=-1e6) * cells / grid.tag_mm + rim + 1, size)
            for place, size in ((x, whole.shape[1]), (y, whole.shape[0]))
        )
        for up, y_share in ((0, 1.0 - upper_share), (1, upper_share)):
            for right, x_share in ((0, 1.0 - right_share), (1, right_share)):
                value += whole[below + up, left + right] * x_share * y_share
        return value

    return ink


def _beside(place: np.ndarray, size: int) -> tuple[np.ndarray, np.ndarray]:
    """Return the cell before the edge next to each sample, and the share of the sample beyond that edge."""
    slope = np.hypot(*np.gradient(place))
    edge = np.clip(np.rint(place), 1, size - 1)
    share = np.clip((place - edge) / np.maximum(slope, 1e-12) + 0.5, 0.0, 1.0)
    return edge.astype(int) - 1, share
