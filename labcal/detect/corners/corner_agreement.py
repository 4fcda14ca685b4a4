"""Corners that agree with the others of their board, within the errors that are stated."""

from dataclasses import dataclass, replace

import numpy as np

from labcal.arrays import Mask, PixelCovariances, Pixels
from labcal.detect.dots import PictureDots
from labcal.detect.flags import DotFlag
from labcal.detect.medians import median_of
from labcal.errors import InputError
from labcal.geometry.projective_map import homogeneous, projective_map
from labcal.geometry.two_by_two import determinants, inverses

_CHANCE = 0.01
"""Probability that a picture without any wrong corner loses one."""
_DEGREES = (0, 2, 3, 4, 5, 6, 7, 8)
"""Of the polynomial beside the homography: none, and what a lens or a bent board adds."""
_IN_VAIN = 2
"""Degrees one after the other that are no better: a lens may add cubic terms alone."""
_FOLLOWED = 0.5
"""Variance that the next degree leaves, over the stated one, beyond which it follows no lens and board."""
_CONFIRMED = 0.5
"""Share of the limit at which a corner disagrees by the next degree, too, which leaves less of its error."""
_SPARE = 2.0
"""Coordinates a parameter, at least."""
_MOST_WRONG = 0.25
"""Share of the corners; where more disagree, the map is wrong and not they."""
_ROUNDS, _ROBUST_ROUNDS, _HALVINGS = 20, 6, 20
_HEAVY = 4.0
"""Degrees of freedom of Student's distribution, whose weights a fit begins with."""
_MEDIAN = 2.0 * np.log(2.0)
"""Of chi-square with two degrees of freedom."""
_LEAST_SHARE = 0.1
"""Of a corner's error that a fit leaves, by its leverage."""
_EFFICIENCY = 0.37
"""Of the median of squares, against their mean."""
_RIDGE, _TINY = 1e-9, 1e-18


def without_disagreeing(dots: PictureDots, board: Pixels) -> PictureDots:
    """Return the corners of a picture, those that disagree with the others flagged ``bad-fit``.

    Parameters
    ----------
    dots : PictureDots
        Of a board that is in place.
    board : ndarray, shape (n, 2)
        Places of the corners on the board, in any unit.
    """
    ok = np.flatnonzero(dots.ok)
    wrong = np.zeros(len(dots.flag), dtype=bool)
    wrong[ok] = ~agreeing(board[ok], dots.position[ok], dots.covariance[ok])
    return replace(
        dots,
        position=np.where(wrong[:, None], np.nan, dots.position),
        covariance=np.where(wrong[:, None, None], np.nan, dots.covariance),
        flag=tuple(
            DotFlag.BAD_FIT if is_wrong else flag for flag, is_wrong in zip(dots.flag, wrong, strict=True)
        ),
    )


def agreeing(board: Pixels, seen: Pixels, covariance: PixelCovariances) -> Mask:
    """Return which corners are where all others of the board predict them, within the stated errors.

    A corner that something covers in part may be fitted well to the edge of what covers it, off by many of
    its standard deviations. The prediction is that of a homography and, where the corners demand it, of a
    polynomial beside it: lenses and bent boards. Its degree is the one of least description length (Schwarz
    1978, Annals of Statistics 6). What no such map follows (waves of the paper, the print) counts as a
    further variance of every corner, from the median residual. A corner disagrees where the squared
    normalised difference from the prediction by the others exceeds what chance gives to one picture in a
    hundred.

    Parameters
    ----------
    board : ndarray, shape (n, 2)
        Places on the board, in any unit.
    seen : ndarray, shape (n, 2)
        The measured corners, px.
    covariance : ndarray, shape (n, 2, 2)
        As stated, px squared.

    Returns
    -------
    ndarray of bool, shape (n,)
        All true where the corners are too few to tell, or more than a quarter of them disagree.
    """
    n = len(board)
    everything = np.ones(n, dtype=bool)
    best, later, plain = None, list[_Judged](), True
    for degree in _DEGREES:
        design = _Design.of(board, seen, degree)
        if design is None:
            break
        judged = design.judged(covariance)
        if best is None or judged.length < best.length:
            best, later, plain = judged, [], degree == 0
        else:
            later.append(judged)
        if len(later) == _IN_VAIN:
            break
    if best is None or not (plain or (later and later[0].more < _FOLLOWED)):
        return everything
    # What a degree leaves out, the next one may follow, though the others do not demand it.
    kept = best.kept | (later[0].off < _CONFIRMED) if later else best.kept
    return kept if (~kept).sum() <= _MOST_WRONG * n else everything


@dataclass(frozen=True)
class _Judged:
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

    kept: Mask
    off: np.ndarray
    more: float
    length: float


@dataclass(frozen=True)
class _Design:
    """Residuals of a homography through corners, and how its changes and a polynomial move these.

    Attributes
    ----------
    left : ndarray, shape (n, 2)
        Measured minus predicted, px.
    rows : ndarray, shape (n, 2, p)
        Change of a prediction by every parameter, px.
    """

    left: np.ndarray
    rows: np.ndarray

    @classmethod
    def of(cls, board: Pixels, seen: Pixels, degree: int) -> "_Design | None":
        """Return the design of a polynomial of a degree; None where there are too few corners for it."""
        terms = [(i, j) for i in range(degree + 1) for j in range(degree + 1 - i) if i + j > 1]
        if 2.0 * len(board) < _SPARE * (8 + 2 * len(terms)):
            return None
        middle = board.mean(axis=0)
        at = (board - middle) / max(float(np.abs(board - middle).max()), _RIDGE)
        H = _homography(at, seen)
        if H is None:
            return None
        xyw = homogeneous(at) @ H.T
        place = xyw[:, :2] / xyw[:, 2:]
        rows = np.zeros((len(at), 2, 8 + 2 * len(terms)))
        one = homogeneous(at) / xyw[:, 2:]
        rows[:, 0, 0:3], rows[:, 1, 3:6] = one, one
        rows[:, :, 6:8] = -place[:, :, None] * one[:, None, :2]
        for k, (i, j) in enumerate(terms):
            rows[:, 0, 8 + 2 * k] = rows[:, 1, 9 + 2 * k] = at[:, 0] ** i * at[:, 1] ** j
        size = np.sqrt((rows**2).sum(axis=(0, 1)))
        return cls(seen - place, rows / np.maximum(size, _RIDGE))

    @property
    def limit(self) -> float:
        """Squared normalised difference that a corner exceeds by chance in one of a hundred pictures.

        Twice the quantile of an F distribution with two degrees of freedom and those of the variance, which
        rests on a median.
        """
        n, _, p = self.rows.shape
        freedom = max(_EFFICIENCY * (2.0 * n - p), 1.0)
        return float(freedom * ((n / _CHANCE) ** (2.0 / freedom) - 1.0))

    def judged(self, covariance: PixelCovariances) -> _Judged:
        """Return which corners agree with the map."""
        (n, _, p), limit = self.rows.shape, self.limit
        more, weight = 0.0, np.ones(n)
        for _ in range(_ROBUST_ROUNDS):
            e = self.left - self.rows @ self._solution(covariance + more * np.eye(2), weight)[0]
            more = _more(e, covariance)
            weight = (_HEAVY + 2.0) / (_HEAVY + _squares(e, covariance + more * np.eye(2)))
        kept = _squares(e, covariance + more * np.eye(2)) < limit
        for _ in range(_ROUNDS):
            total = covariance + more * np.eye(2)
            solution, spread = self._solution(total, kept.astype(np.float64))
            e = self.left - self.rows @ solution
            of_prediction = (self.rows @ spread) @ np.swapaxes(self.rows, 1, 2)
            sign = np.where(kept, -1.0, 1.0)[:, None, None]
            off = _squares(e, total + sign * of_prediction + _RIDGE * np.eye(2))
            if kept.any():
                # What a fit leaves of a corner that counts in it is less than its error.
                share = np.einsum("nij,nji->n", of_prediction[kept], inverses(total[kept])) / 2.0
                more = _more(
                    e[kept] / np.sqrt(np.maximum(1.0 - share, _LEAST_SHARE))[:, None], covariance[kept]
                )
            agreed = off < limit
            # Of those that disagree the worst ones go first: they may have moved the prediction of others.
            agreed |= kept & (off < 0.5 * off[kept].max(initial=0.0))
            if (agreed == kept).all():
                break
            kept = agreed
        total = covariance + more * np.eye(2)
        cost = np.log(determinants(total)) + np.minimum(_squares(e, total), limit)
        usual = max(0.5 * median_of(covariance[:, 0, 0] + covariance[:, 1, 1]), _TINY)
        return _Judged(kept, off / limit, more / usual, float(cost.sum() + p * np.log(2.0 * n)))

    def _solution(self, total: PixelCovariances, weight: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        """Return the parameters of weighted least squares, shape (p,), and their covariance."""
        W = weight[:, None, None] * inverses(total)
        x, y = self.rows[:, 0], self.rows[:, 1]
        of_x, of_y = W[:, 0, :1] * x + W[:, 0, 1:] * y, W[:, 1, :1] * x + W[:, 1, 1:] * y
        normal = x.T @ of_x + y.T @ of_y
        scale = np.sqrt(np.maximum(np.diag(normal), _RIDGE))
        spread = np.linalg.inv(normal / np.outer(scale, scale) + _RIDGE * np.eye(len(scale)))
        spread /= np.outer(scale, scale)
        return spread @ (of_x.T @ self.left[:, 0] + of_y.T @ self.left[:, 1]), spread


def _homography(at: Pixels, seen: Pixels) -> np.ndarray | None:
    """Return the homography of corners; None where they determine none, or it has its horizon among them."""
    try:
        H = projective_map("corners", at, seen)
    except InputError:
        return None
    w = homogeneous(at) @ H[2]
    return None if (w * w[0] <= 0.0).any() else H


def _squares(e: np.ndarray, covariance: np.ndarray) -> np.ndarray:
    """Return squared normalised residuals, shape (n,)."""
    return np.asarray(_adjugate_squares(e, covariance) / determinants(covariance))


def _adjugate_squares(e: np.ndarray, M: np.ndarray) -> np.ndarray:
    """Return ``e' adj(M) e`` of vectors (n, 2) and symmetric matrices (n, 2, 2), shape (n,)."""
    x, y = e.T
    return np.asarray(M[:, 1, 1] * x * x - 2.0 * M[:, 0, 1] * x * y + M[:, 0, 0] * y * y)


def _more(e: np.ndarray, covariance: np.ndarray) -> float:
    """Return the further variance at which the median squared normalised residual is that of chance, px^2.

    With a variance t beside, the adjugate of a covariance S is ``adj(S) + t`` and its determinant
    ``det(S) + t tr(S) + t^2``.
    """
    e2, adjugate = (e**2).sum(axis=1), _adjugate_squares(e, covariance)
    det, trace = np.maximum(determinants(covariance), _TINY), covariance[:, 0, 0] + covariance[:, 1, 1]

    def is_over(more: float) -> bool:
        return bool(median_of((adjugate + more * e2) / (det + more * trace + more * more)) > _MEDIAN)

    if not is_over(0.0):
        return 0.0
    low, high = 0.0, median_of(e2)
    for _ in range(_HALVINGS):
        middle = 0.5 * (low + high)
        low, high = (middle, high) if is_over(middle) else (low, middle)
    return high
