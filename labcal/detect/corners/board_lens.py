"""Lens that shows a board: a homography and radial distortion, where corners demand one."""

from dataclasses import dataclass

import numpy as np

from labcal.arrays import Pixels
from labcal.detect.corners.lens_fit import ALL, HOMOGRAPHY, RADIAL, fit_lens
from labcal.errors import InputError
from labcal.geometry.projective_map import projective_map

_SPARE = 10
"""Coordinates of corners beyond the parameters, at least."""
_DEMANDED = 20.0
"""F ratio of what a lens explains, above which it is one; of noise it is 4 in one of 1000."""
_LEAST_GAIN = 0.25
"""Of the squared residuals of a homography that a lens explains: else something else bends the board."""
_NEWTON = 5


@dataclass(frozen=True)
class BoardLens:
    """Map from the picture to a board through a lens with radial distortion.

    ``A (x, y, 1 + a r^2 + b r^4 + c r^6)``, homogeneous, with the offset (x, y) from the centre of distortion
    over half the picture's larger side, and its length r. This is the division model (Fitzgibbon 2001,
    Simultaneous linear estimation of multiple view geometry and lens distortion) with more terms; of a
    fisheye the series is ``r / tan r``, which converges over the whole half space.

    Attributes
    ----------
    A : ndarray, shape (3, 3)
    centre : ndarray, shape (2,)
        Of the distortion, px.
    terms : ndarray, shape (3,)
    unit : float
        Half the larger side of the picture, px.
    """

    A: np.ndarray
    centre: np.ndarray
    terms: np.ndarray
    unit: float

    def on_board(self, q: Pixels) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
        """Return places on the board (n, 2), their slopes by the picture (n, 2, 2), 1/px, and horizons.

        The horizons are the relative slopes of the depth, 1/px, shape (n, 2).
        """
        slope_w, homogeneous = self._parts(q)
        plane = homogeneous @ self.A.T
        by_q = (self.A[:, :2] + self.A[:, 2:] * slope_w[:, None, :]) / self.unit
        place = plane[:, :2] / plane[:, 2:]
        horizon = by_q[:, 2] / plane[:, 2:]
        return place, by_q[:, :2] / plane[:, 2:, None] - place[..., None] * horizon[:, None], horizon

    def in_picture(self, board: np.ndarray, near: Pixels) -> Pixels:
        """Return where places on the board are seen, px, by Newton's method from places near these on."""
        q = near.copy()
        for _ in range(_NEWTON):
            place, slope, _ = self.on_board(q)
            q = q + np.linalg.solve(slope, (board - place)[..., None])[..., 0]
        return q

    def _parts(self, q: Pixels) -> tuple[np.ndarray, np.ndarray]:
        """Return the slope of the third coordinate by (x, y), (n, 2), and all three (n, 3)."""
        x = (q - self.centre) / self.unit
        square, (a, b, c) = (x * x).sum(axis=1), self.terms
        slope = 2.0 * (a + square * (2.0 * b + square * 3.0 * c))
        third = 1.0 + square * (a + square * (b + square * c))
        return slope[:, None] * x, np.column_stack([x, third])


def board_lens(board: np.ndarray, q: Pixels, size: tuple[int, int]) -> BoardLens | None:
    """Return the lens that shows a board's corners; None where they do not demand one.

    Corners that something covers in part may be off: the fit has the weights of Student's distribution.

    Parameters
    ----------
    board : ndarray, shape (n, 2)
        Places on the board, in squares.
    q : ndarray, shape (n, 2)
        Measured corners, px.
    size : (int, int)
        Width and height of the picture, px.
    """
    spare = 2 * len(q) - ALL
    if spare < _SPARE:
        return None
    board, q = np.ascontiguousarray(board, dtype=np.float64), np.ascontiguousarray(q)
    try:
        to_picture = projective_map("corners", board, q)
    except InputError:
        return None
    unit, centre = 0.5 * max(size), 0.5 * (np.array(size, dtype=np.float64) - 1.0)
    to_px = np.array([[unit, 0.0, centre[0]], [0.0, unit, centre[1]], [0.0, 0.0, 1.0]])
    A = np.linalg.inv(to_picture) @ to_px
    lens = np.concatenate([(A / np.linalg.norm(A)).ravel(), centre, np.zeros(RADIAL)])
    ok, of_plane, of_lens = fit_lens(lens, (board, q), unit, centre)
    gain = of_plane - of_lens
    if not ok or gain < _LEAST_GAIN * of_plane or gain * spare < _DEMANDED * (ALL - HOMOGRAPHY) * of_lens:
        return None
    return BoardLens(lens[:9].reshape(3, 3), lens[9:11], lens[11:], unit)
