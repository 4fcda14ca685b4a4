"""Corners that agree with the others of their board, within the errors that are stated."""

from dataclasses import dataclass, replace

import numpy as np

from labcal.arrays import Mask, PixelCovariances, Pixels
from labcal.detect.corners.map_judgement import Judged, judged
from labcal.detect.dots import PictureDots
from labcal.detect.flags import DotFlag
from labcal.errors import InputError
from labcal.geometry.projective_map import homogeneous, projective_map

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
_HOMOGRAPHY = 8
"""Parameters."""
_RIDGE = 1e-9


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
    best, later, plain = None, list[Judged](), True
    under = _Plain.of(board, seen) if 2.0 * n >= _SPARE * _HOMOGRAPHY else None
    if under is None:
        return everything
    for degree in _DEGREES:
        terms = [(i, j) for i in range(degree + 1) for j in range(degree + 1 - i) if i + j > 1]
        if 2.0 * n < _SPARE * (_HOMOGRAPHY + 2 * len(terms)):
            break
        left, rows = under.design(terms)
        one = judged(left, rows, covariance)
        if best is None or one.length < best.length:
            best, later, plain = one, [], degree == 0
        else:
            later.append(one)
        if len(later) == _IN_VAIN:
            break
    if best is None or not (plain or (later and later[0].more < _FOLLOWED)):
        return everything
    # What a degree leaves out, the next one may follow, though the others do not demand it.
    kept = best.kept | (later[0].off < _CONFIRMED) if later else best.kept
    return kept if (~kept).sum() <= _MOST_WRONG * n else everything


@dataclass(frozen=True)
class _Plain:
    """Corners under the homography through them.

    Attributes
    ----------
    at : ndarray, shape (n, 2)
        On the board about their middle, to 1 at most.
    H : ndarray, shape (3, 3)
    seen : ndarray, shape (n, 2)
        The measured corners, px.
    """

    at: Pixels
    H: np.ndarray
    seen: Pixels

    @classmethod
    def of(cls, board: Pixels, seen: Pixels) -> "_Plain | None":
        """Return the map; None where corners determine none, or it has its horizon among them."""
        middle = board.mean(axis=0)
        at = (board - middle) / max(float(np.abs(board - middle).max()), _RIDGE)
        try:
            H = projective_map("corners", at, seen)
        except InputError:
            return None
        w = homogeneous(at) @ H[2]
        return None if (w * w[0] <= 0.0).any() else cls(at, H, seen)

    def design(self, terms: list[tuple[int, int]]) -> tuple[np.ndarray, np.ndarray]:
        """Return measured minus predicted (2, n), px, and how parameters move predictions (p, 2, n).

        The parameters are the changes of the homography and, along x and along y, the terms of a polynomial.
        """
        (x, y), one = self.at.T, np.ones(len(self.at))
        xyw = self.H @ np.stack([x, y, one])
        place = xyw[:2] / xyw[2]
        rows = np.zeros((_HOMOGRAPHY + 2 * len(terms), 2, len(self.at)))
        rows[0:3, 0] = rows[3:6, 1] = np.stack([x, y, one]) / xyw[2]
        rows[6:8] = -rows[0:2, :1] * place
        for k, (i, j) in enumerate(terms):
            at = _HOMOGRAPHY + 2 * k
            rows[at, 0] = rows[at + 1, 1] = x**i * y**j
        rows /= np.maximum(np.sqrt((rows**2).sum(axis=(1, 2), keepdims=True)), _RIDGE)
        return np.ascontiguousarray(self.seen.T - place), rows
