"""Contours of dark spots: their boxes, their moments, and how far they are from ellipses, compiled."""

from math import sqrt

import numpy as np

from labcal.detect.compiled import compiled

LOW, HIGH, AREA, CENTRE, SHAPE, SCATTER = slice(0, 2), slice(2, 4), 4, slice(5, 7), slice(7, 10), 10
"""Columns: box 4, area, centre 2, xx xy yy of the outline matrix, scatter about the ellipse, a radius."""
_COLUMNS = 11


@compiled
def contour_table(points: np.ndarray, ends: np.ndarray) -> np.ndarray:
    """Return what contours are like, shape (n, 11), in pixels.

    Moments are those of the closed polygons, by Green's theorem; an outline matrix is four times the
    covariance. Area and scatter are 0 and infinite where a contour encloses nothing, or a line.

    Parameters
    ----------
    points : ndarray of int, shape (m, 2)
        Of all contours, one after the other.
    ends : ndarray of int, shape (n,)
        Number of the point behind each contour's last one.
    """
    table = np.zeros((len(ends), _COLUMNS))
    first = 0
    for number in range(len(ends)):
        row, contour = table[number], points[first : ends[number]]
        first = ends[number]
        row[0], row[1], row[2], row[3] = np.inf, np.inf, -np.inf, -np.inf
        for k in range(len(contour)):
            x, y = float(contour[k, 0]), float(contour[k, 1])
            row[0], row[1], row[2], row[3] = min(row[0], x), min(row[1], y), max(row[2], x), max(row[3], y)
        _write_moments(contour, row)
        determinant = row[7] * row[9] - row[8] * row[8]
        if not (row[4] > 0.0 and determinant > 0.0 and row[7] > 0.0):
            row[4], row[10] = 0.0, np.inf
            continue
        row[10] = _scatter(contour, row, determinant)
    return table


@compiled
def _write_moments(contour: np.ndarray, row: np.ndarray) -> None:
    """Write a polygon's area, centre and outline matrix; 0 where the area is 0."""
    middle_x, middle_y = 0.5 * (row[0] + row[2]), 0.5 * (row[1] + row[3])
    total, sum_x, sum_y, sum_xx, sum_xy, sum_yy = 0.0, 0.0, 0.0, 0.0, 0.0, 0.0
    x, y = contour[-1, 0] - middle_x, contour[-1, 1] - middle_y
    for k in range(len(contour)):
        u, v = contour[k, 0] - middle_x, contour[k, 1] - middle_y
        cross = x * v - u * y
        total += cross
        sum_x += cross * (x + u)
        sum_y += cross * (y + v)
        sum_xx += cross * (x * x + x * u + u * u)
        sum_yy += cross * (y * y + y * v + v * v)
        sum_xy += cross * (x * v + 2.0 * x * y + 2.0 * u * v + u * y)
        x, y = u, v
    if total == 0.0:
        return
    x, y = sum_x / (3.0 * total), sum_y / (3.0 * total)
    row[4], row[5], row[6] = 0.5 * abs(total), middle_x + x, middle_y + y
    row[7] = 4.0 * (sum_xx / (6.0 * total) - x * x)
    row[8] = 4.0 * (sum_xy / (12.0 * total) - x * y)
    row[9] = 4.0 * (sum_yy / (6.0 * total) - y * y)


@compiled
def _scatter(contour: np.ndarray, row: np.ndarray, determinant: float) -> float:
    """Return the standard deviation of the radius where the ellipse is the unit circle."""
    xx, xy, yy = row[9] / determinant, -row[8] / determinant, row[7] / determinant
    total, count = 0.0, len(contour)
    radius = np.empty(count)
    for k in range(count):
        x, y = contour[k, 0] - row[5], contour[k, 1] - row[6]
        radius[k] = sqrt(xx * x * x + 2.0 * xy * x * y + yy * y * y)
        total += radius[k]
    squares = 0.0
    for k in range(count):
        squares += (radius[k] - total / count) ** 2
    return sqrt(squares / count)
