"""Likeness of the pixels of a picture to saddle points, and the strongest of them, in compiled code."""

import numpy as np

from labcal.detect.compiled import compiled

_NEAR = 2
"""Pixels to either side of which one is the strongest."""
_TOGETHER = 64
"""Pixels of a row."""
_LESS = 1.0 - 1e-6
"""Of a strength that is not negative: no more than it in single precision, either."""
_QUARTER, _HALF, _TWO = np.float32(0.25), np.float32(0.5), np.float32(2.0)


@compiled
def saddle_strength(smooth: np.ndarray) -> np.ndarray:
    """Return the negative determinant of the second derivatives by central differences, shape (h, w).

    Parameters
    ----------
    smooth : ndarray of float32, shape (h, w)

    Returns
    -------
    ndarray of float32
        0 at the rim of the picture.
    """
    height, width = smooth.shape
    strength = np.zeros((height, width), dtype=np.float32)
    for j in range(1, height - 1):
        above, here, below, out = smooth[j - 1], smooth[j], smooth[j + 1], strength[j]
        for i in range(1, width - 1):
            twice = _TWO * here[i]
            xx, yy = here[i - 1] - twice + here[i + 1], above[i] - twice + below[i]
            xy = _QUARTER * ((below[i + 1] - below[i - 1]) - (above[i + 1] - above[i - 1]))
            out[i] = xy * xy - xx * yy
    return strength


@compiled
def strongest_places(strength: np.ndarray, least: float) -> tuple[np.ndarray, np.ndarray]:
    """Return row and column of the pixels above a least strength than which none near is stronger."""
    height, width = strength.shape
    most = height * width // 4 + 1
    y, x = np.empty(most, dtype=np.int64), np.empty(most, dtype=np.int64)
    n, weak = 0, np.float32(_LESS * least)
    for j in range(1, height - 1):
        for first in range(1, width - 1, _TOGETHER):
            # Most pixels are weak: the processor counts the others several pixels at a time.
            some, above = strength[j, first : min(first + _TOGETHER, width - 1)], 0
            for i in range(len(some)):
                above += some[i] > weak
            if above == 0:
                continue
            for i in range(len(some)):
                if some[i] > least and n < most and _is_strongest(strength, j, first + i):
                    y[n], x[n] = j, first + i
                    n += 1
    return y[:n].copy(), x[:n].copy()


@compiled
def _is_strongest(strength: np.ndarray, j: int, i: int) -> bool:
    """Tell whether no pixel near one, which is not at the rim, is stronger."""
    own = strength[j, i]
    # Those next to it are looked at first: of nearly all pixels one of them is stronger.
    if (
        strength[j, i - 1] > own
        or strength[j, i + 1] > own
        or strength[j - 1, i] > own
        or strength[j + 1, i] > own
    ):
        return False
    for down in range(max(j - _NEAR, 0), min(j + _NEAR + 1, strength.shape[0])):
        for across in range(max(i - _NEAR, 0), min(i + _NEAR + 1, strength.shape[1])):
            if strength[down, across] > own:
                return False
    return True


@compiled
def saddle_places(
    smooth: np.ndarray, strength: np.ndarray, pixels: tuple[np.ndarray, np.ndarray], farthest: float
) -> tuple[np.ndarray, np.ndarray]:
    """Return the saddle points near pixels by one step of Newton's method; and of which pixels these are.

    Parameters
    ----------
    smooth : ndarray of float32, shape (h, w)
    strength : ndarray of float32, shape (h, w)
        Of :func:`saddle_strength`.
    pixels : (ndarray of int, ndarray of int), shape (n,) each
        Row and column, within the picture.
    farthest : float
        A step along either axis is shorter, px.

    Returns
    -------
    (ndarray, shape (m, 2); ndarray of int, shape (m,))
    """
    rows, columns = pixels
    places, which, m = np.empty((len(rows), 2)), np.empty(len(rows), dtype=np.int64), 0
    for k in range(len(rows)):
        y, x = rows[k], columns[k]
        above, here, below = smooth[y - 1], smooth[y], smooth[y + 1]
        by_x, by_y = _HALF * (here[x + 1] - here[x - 1]), _HALF * (below[x] - above[x])
        twice = _TWO * here[x]
        xx, yy = here[x - 1] - twice + here[x + 1], above[x] - twice + below[x]
        xy = _QUARTER * ((below[x + 1] - below[x - 1]) - (above[x + 1] - above[x - 1]))
        right, down = (yy * by_x - xy * by_y) / strength[y, x], (xx * by_y - xy * by_x) / strength[y, x]
        if max(abs(right), abs(down)) < farthest:
            places[m, 0], places[m, 1], which[m] = x + right, y + down, k
            m += 1
    return places[:m].copy(), which[:m].copy()
