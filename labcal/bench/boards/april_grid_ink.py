"""The print of an AprilGrid as a function of the place on it, to draw pictures from."""

from math import floor, hypot

import numpy as np

from labcal.bench.marks.drawn_picture import Print
from labcal.detect.compiled import compiled
from labcal.targets.april_grid import AprilGrid
from labcal.targets.april_grid_outlines import tag_cells

PAPER_CELLS = 3
"""White paper around the print."""
_ROUNDING = 1e-9
"""Of a number of cells."""
_BEYOND = 0.6
"""Share of ink of what lies behind the paper."""
_FLATTEST = 1e-12
"""Cells a sample."""


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
    for row in range(grid.tag_rows + 1 if grid.corner_squares else 0):
        for col in range(grid.tag_cols + 1):
            y, x = PAPER_CELLS + pitch * row, PAPER_CELLS + pitch * col
            whole[y : y + gap, x : x + gap] = 1.0
    whole = np.pad(whole, 1, constant_values=_BEYOND)

    def ink(x: np.ndarray, y: np.ndarray) -> np.ndarray:
        scale = cells / grid.tag_mm
        return np.asarray(
            _ink_at(np.asarray(x, dtype=np.float64) * scale, np.asarray(y) * scale, rim + 1, whole)
        )

    return ink


@compiled
def _ink_at(x: np.ndarray, y: np.ndarray, first: int, whole: np.ndarray) -> np.ndarray:
    """Return the share of ink of samples (h, w) at places in cells; `whole` (rows, cols) is of cells.

    Cell (first, first) is that at the origin. NaN is behind the camera.
    """
    height, width = x.shape
    value = np.full((height, width), whole[0, 0])
    for j in range(height):
        for i in range(width):
            if np.isnan(x[j, i]) or np.isnan(y[j, i]):
                continue
            col, right = _beside(x, j, i, first, whole.shape[1])
            row, upper = _beside(y, j, i, first, whole.shape[0])
            below = (1.0 - right) * whole[row, col] + right * whole[row, col + 1]
            above = (1.0 - right) * whole[row + 1, col] + right * whole[row + 1, col + 1]
            value[j, i] = (1.0 - upper) * below + upper * above
    return value


@compiled
def _beside(place: np.ndarray, j: int, i: int, first: int, size: int) -> tuple[int, float]:
    """Return the cell before the edge next to a sample, and the share of the sample beyond that edge."""
    height, width = place.shape
    up, down = max(j - 1, 0), min(j + 1, height - 1)
    left, right = max(i - 1, 0), min(i + 1, width - 1)
    slope = hypot(
        (place[down, i] - place[up, i]) / max(down - up, 1),
        (place[j, right] - place[j, left]) / max(right - left, 1),
    )
    at = place[j, i] + first
    edge = min(max(floor(at + 0.5), 1), size - 1)
    share = min(max((at - edge) / max(slope, _FLATTEST) + 0.5, 0.0), 1.0)
    return edge - 1, share
