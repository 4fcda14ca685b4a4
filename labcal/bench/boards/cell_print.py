"""A print of black and white cells between lines, as a function of the place on it, to draw pictures from."""

import numpy as np

from labcal.bench.marks.drawn_picture import Print

_BINS_A_CELL = 64
"""Entries of the table of nearest lines, in the narrowest cell."""


def cell_ink(x_lines: np.ndarray, y_lines: np.ndarray, share: np.ndarray) -> Print:
    """Return the share of ink at places of a print.

    A line is linear across a sample: along the rows of samples it would else be off by up to half of one.

    Parameters
    ----------
    x_lines : ndarray, shape (n - 1,)
        Places of the lines along x, ascending, in the unit of the print.
    y_lines : ndarray, shape (m - 1,)
        The same along y.
    share : ndarray, shape (m, n)
        Ink between the lines, row 0 at the lowest y, 0 to 1; the first and last rows and columns go on
        without end.

    Returns
    -------
    callable
        Of places x and y on samples in rows and columns, shape (h, w) each; NaN is outside.
    """
    tables = _table(x_lines), _table(y_lines)
    lines = np.asarray(x_lines), np.asarray(y_lines)

    def ink(x: np.ndarray, y: np.ndarray) -> np.ndarray:
        (left, right_share), (below, upper_share) = (
            _beside(place, *of_axis)
            for place, of_axis in zip((x, y), zip(lines, tables, strict=True), strict=True)
        )
        lower = share[below, left] * (1.0 - right_share) + share[below, left + 1] * right_share
        upper = share[below + 1, left] * (1.0 - right_share) + share[below + 1, left + 1] * right_share
        return np.asarray(lower * (1.0 - upper_share) + upper * upper_share)

    return ink


def _table(lines: np.ndarray) -> np.ndarray:
    """Return the number of the line nearest to places in even steps from the first to the last line."""
    step = float(np.diff(lines).min()) / _BINS_A_CELL
    places = lines[0] + step * np.arange(int(np.ceil((lines[-1] - lines[0]) / step)) + 1)
    return np.asarray(np.searchsorted(0.5 * (lines[1:] + lines[:-1]), places))


def _beside(place: np.ndarray, lines: np.ndarray, table: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Return the cell before the line next to each sample, and the share of the sample beyond that line."""
    known = np.nan_to_num(place, nan=float(lines[0]) - 1e6)
    slope = np.hypot(*np.gradient(known))
    per_entry = (len(table) - 1) / (lines[-1] - lines[0])
    near = table[np.clip((known - lines[0]) * per_entry, 0, len(table) - 1).astype(np.int64)]
    beyond = np.clip((known - lines[near]) / np.maximum(slope, 1e-12) + 0.5, 0.0, 1.0)
    return near, beyond
