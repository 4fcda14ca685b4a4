"""Comparison of the corners of a board with a map of it, a homography with a polynomial beside, compiled."""

from math import log, sqrt
from typing import NamedTuple

import numpy as np

from labcal.detect.cholesky import factorise, solve
from labcal.detect.compiled import compiled
from labcal.detect.row_products import HIGH, add_own_products, copy_columns, filled_up

_CHANCE = 0.01
"""Probability that a picture without any wrong corner loses one."""
_WEAK = 16.0
"""Stated variance, of the usual one, of a corner that is mostly covered: such a one is often fitted to what
covers it."""
_WEAK_CHANCE = 0.01
"""Probability that such a corner is lost by chance."""
_ROUNDS, _ROBUST_ROUNDS, _HALVINGS = 20, 6, 20
_HEAVY = 4.0
"""Degrees of freedom of Student's distribution, whose weights a fit begins with."""
_MEDIAN = 2.0 * log(2.0)
"""Of chi-square with two degrees of freedom."""
_LEAST_SHARE = 0.1
"""Of a corner's error that a fit leaves, by its leverage."""
_EFFICIENCY = 0.37
"""Of the median of squares, against their mean."""
_RIDGE, _TINY = 1e-9, 1e-18


class Judged(NamedTuple):
    """Corners compared with a map.

    Attributes
    ----------
    kept : ndarray of bool, shape (n,)
        Which agree.
    off : ndarray, shape (n,)
        Squared normalised difference from the prediction by the others, over its limit.
    more : float
        Variance that the map does not follow, over the usual stated one.
    length : float
        Description length of all, each one counted up to a limit.
    """

    kept: np.ndarray
    off: np.ndarray
    more: float
    length: float


@compiled
def judged(left: np.ndarray, rows: np.ndarray, covariance: np.ndarray) -> Judged:
    """Return which corners agree with the best map of a kind, and by how much it follows them.

    Parameters
    ----------
    left : ndarray, shape (2, n)
        Measured minus predicted by a map near the best one, px.
    rows : ndarray, shape (p, 2, n)
        Change of a prediction by every parameter, px.
    covariance : ndarray, shape (n, 2, 2)
        As stated, px squared.
    """
    p, _, n = rows.shape
    usual = max(0.5 * _median(covariance[:, 0, 0] + covariance[:, 1, 1]), _TINY)
    limit = np.full(n, _limit(n, p, n / _CHANCE))
    for k in range(n):
        if covariance[k, 0, 0] + covariance[k, 1, 1] > 2.0 * _WEAK * usual:
            limit[k] = _limit(n, p, 1.0 / _WEAK_CHANCE)
    more, weight, e = 0.0, np.ones(n), left
    for _ in range(_ROBUST_ROUNDS):
        e = _solved(left, rows, _raised(covariance, more), weight)[0]
        more = _more(e, covariance)
        weight = (_HEAVY + 2.0) / (_HEAVY + _squares(e, _raised(covariance, more)))
    kept = _squares(e, _raised(covariance, more)) < limit
    off = np.zeros(n)
    for _ in range(_ROUNDS):
        total = _raised(covariance, more)
        e, prediction = _solved(left, rows, total, kept.astype(np.float64))
        off = _squares(e, _differences(total, prediction, kept))
        if kept.any():
            share = np.maximum(1.0 - _leverages(total, prediction), _LEAST_SHARE)
            # What a fit leaves of a corner that counts in it is less than its error.
            more = _more((e / np.sqrt(share))[:, kept], covariance[kept])
        agreed, worst = off < limit, 0.0
        for k in range(n):
            if kept[k]:
                worst = max(worst, off[k])
        # Of those that disagree the worst ones go first: they may have moved the prediction of others.
        agreed |= kept & (off < 0.5 * worst)
        if (agreed == kept).all():
            break
        kept = agreed
    total = _raised(covariance, more)
    squares, length = _squares(e, total), p * log(2.0 * n)
    for k in range(n):
        length += log(_determinant(total[k])) + min(squares[k], limit[k])
    return Judged(kept, off / limit, more / usual, length)


@compiled
def _limit(n: int, p: int, times: float) -> float:
    """Return the squared normalised difference that a corner exceeds by chance once in so many times.

    Twice the quantile of an F distribution with two degrees of freedom and those of the variance, which
    rests on a median.
    """
    freedom = max(_EFFICIENCY * (2.0 * n - p), 1.0)
    found: float = freedom * (times ** (2.0 / freedom) - 1.0)
    return found


@compiled
def _solved(
    left: np.ndarray, rows: np.ndarray, total: np.ndarray, weight: np.ndarray
) -> tuple[np.ndarray, np.ndarray]:
    """Return what weighted least squares leave (2, n), and the covariances of their prediction (n, 3).

    These are xx, xy and yy.
    """
    p, _, n = rows.shape
    high, width = -(-(p + 1) // HIGH) * HIGH, filled_up(2 * n)
    table, normal = np.zeros((high, width)), np.zeros((high, high))
    for k in range(n):
        # The rows times the root of the inverse covariance.
        a = max(total[k, 0, 0], _TINY)
        lean = total[k, 0, 1] / a
        of_x, of_y = sqrt(weight[k] / a), sqrt(weight[k] / max(total[k, 1, 1] - lean * total[k, 0, 1], _TINY))
        for i in range(p):
            table[i, k], table[i, n + k] = of_x * rows[i, 0, k], of_y * (rows[i, 1, k] - lean * rows[i, 0, k])
        table[p, k], table[p, n + k] = of_x * left[0, k], of_y * (left[1, k] - lean * left[0, k])
    add_own_products(table, width, normal)
    scale = np.empty(p)
    for i in range(p):
        scale[i] = 1.0 / sqrt(max(normal[i, i], _RIDGE))
    for i in range(p):
        for j in range(i + 1):
            normal[i, j] *= scale[i] * scale[j]
        normal[i, i] += _RIDGE
    right = normal[p, :p] * scale
    factorise(normal, p, 0.0)
    solve(normal, right)
    flat = np.ascontiguousarray(rows).reshape(p, 2 * n)
    copy_columns(flat, 0, table, (0, 2 * n))
    e = np.empty((2, n))
    e[:] = left
    own = e.reshape(2 * n)
    for i in range(p):
        _add(own, -right[i] * scale[i], table[i])
        table[i] *= scale[i]
        for j in range(i):
            _add(table[i], -normal[i, j], table[j])
        table[i] /= normal[i, i]
    prediction = np.zeros((n, 3))
    for i in range(p):
        for k in range(n):
            x, y = table[i, k], table[i, n + k]
            prediction[k, 0] += x * x
            prediction[k, 1] += x * y
            prediction[k, 2] += y * y
    return e, prediction


@compiled
def _add(row: np.ndarray, factor: float, other: np.ndarray) -> None:
    """Add a multiple of another row, which may be longer, to one, in place."""
    for k in range(len(row)):
        row[k] += factor * other[k]


@compiled
def _raised(covariance: np.ndarray, more: float) -> np.ndarray:
    """Return covariances with a further variance, the same in all directions."""
    total = covariance.copy()
    total[:, 0, 0] += more
    total[:, 1, 1] += more
    return total


@compiled
def _differences(total: np.ndarray, prediction: np.ndarray, kept: np.ndarray) -> np.ndarray:
    """Return the covariances of what is left of corners that count in their own prediction or do not."""
    found = np.empty_like(total)
    for k in range(len(total)):
        sign = -1.0 if kept[k] else 1.0
        found[k, 0, 0] = total[k, 0, 0] + sign * prediction[k, 0] + _RIDGE
        found[k, 1, 1] = total[k, 1, 1] + sign * prediction[k, 2] + _RIDGE
        found[k, 0, 1] = found[k, 1, 0] = total[k, 0, 1] + sign * prediction[k, 1]
    return found


@compiled
def _leverages(total: np.ndarray, prediction: np.ndarray) -> np.ndarray:
    """Return by how much of their own error corners move their prediction, in the mean of directions."""
    found = np.empty(len(total))
    for k in range(len(total)):
        xx, xy, yy = prediction[k, 0], prediction[k, 1], prediction[k, 2]
        product = total[k, 1, 1] * xx - 2.0 * total[k, 0, 1] * xy + total[k, 0, 0] * yy
        found[k] = 0.5 * product / _determinant(total[k])
    return found


@compiled
def _determinant(M: np.ndarray) -> float:
    """Return the determinant of a 2 x 2 matrix."""
    found: float = M[0, 0] * M[1, 1] - M[0, 1] * M[1, 0]
    return found


@compiled
def _squares(e: np.ndarray, covariance: np.ndarray) -> np.ndarray:
    """Return squared normalised residuals, shape (n,), of residuals (2, n)."""
    found = np.empty(len(covariance))
    for k in range(len(covariance)):
        found[k] = _adjugate_square(e[0, k], e[1, k], covariance[k]) / _determinant(covariance[k])
    return found


@compiled
def _adjugate_square(x: float, y: float, M: np.ndarray) -> float:
    """Return ``e' adj(M) e`` of a vector and a symmetric matrix."""
    found: float = M[1, 1] * x * x - 2.0 * M[0, 1] * x * y + M[0, 0] * y * y
    return found


@compiled
def _more(e: np.ndarray, covariance: np.ndarray) -> float:
    """Return the further variance at which the median squared normalised residual is that of chance, px^2.

    With a variance t beside, the adjugate of a covariance S is ``adj(S) + t`` and its determinant
    ``det(S) + t tr(S) + t^2``.
    """
    n = len(covariance)
    parts = np.empty((4, n))
    for k in range(n):
        x, y, S = e[0, k], e[1, k], covariance[k]
        parts[0, k], parts[1, k] = _adjugate_square(x, y, S), x * x + y * y
        parts[2, k], parts[3, k] = max(_determinant(S), _TINY), S[0, 0] + S[1, 1]
    if not _is_over(parts, 0.0):
        return 0.0
    low, high = 0.0, _median(parts[1])
    for _ in range(_HALVINGS):
        middle = 0.5 * (low + high)
        if _is_over(parts, middle):
            low = middle
        else:
            high = middle
    return high


@compiled
def _is_over(parts: np.ndarray, more: float) -> bool:
    """Tell whether the median squared normalised residual is above that of chance; not where one is NaN."""
    adjugate, e2, det, trace = parts
    n, above = len(e2), 0
    under, over = -np.inf, np.inf
    for k in range(n):
        square = (adjugate[k] + more * e2[k]) / (det[k] + more * trace[k] + more * more)
        if square > _MEDIAN:
            above += 1
            over = min(over, square)
        elif square <= _MEDIAN:
            under = max(under, square)
        else:
            return False
    if 2 * above == n:
        return 0.5 * (under + over) > _MEDIAN
    return 2 * above > n


@compiled
def _median(values: np.ndarray) -> float:
    """Return the median of at least one number."""
    ordered, count = np.sort(values), len(values)
    middle: float = 0.5 * (ordered[(count - 1) // 2] + ordered[count // 2])
    return middle
