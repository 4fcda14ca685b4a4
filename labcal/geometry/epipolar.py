"""Epipolar geometry of two pinhole cameras: a test whether two sets of pixels can show the same points."""

import numpy as np

from labcal.arrays import Pixels

_FEWEST = 9  # pairs: eight determine the matrix


def epipolar_misfit(q_a: Pixels, q_b: Pixels) -> float:
    """Return the RMS Sampson distance of pairs of points from the fundamental matrix that fits them best.

    The matrix is that of the eight-point algorithm with normalised coordinates (Hartley 1997), the distance
    Sampson's (Hartley and Zisserman, eq. 11.9). Lenses are assumed to be pinholes, so distortion adds to the
    result.

    Parameters
    ----------
    q_a, q_b : ndarray, shape (n, 2)
        The points in the two pictures, px.

    Returns
    -------
    float
        Root mean square, px; infinite where there are too few pairs.
    """
    if len(q_a) < _FEWEST:
        return float("inf")
    (a, N_a), (b, N_b) = _normalised(q_a), _normalised(q_b)
    design = np.einsum("ni,nj->nij", b, a).reshape(-1, 9)
    # The right singular vector of the least value, from the small product: thousands of rows are common.
    F = np.linalg.eigh(design.T @ design)[1][:, 0].reshape(3, 3)
    U, S, V = np.linalg.svd(F)
    F = N_b.T @ (U * [S[0], S[1], 0.0]) @ V @ N_a
    one = np.ones((len(q_a), 1))
    x_a, x_b = np.concatenate([q_a, one], axis=1), np.concatenate([q_b, one], axis=1)
    line_b, line_a = x_a @ F.T, x_b @ F
    squares = (x_b * line_b).sum(axis=1) ** 2
    squares /= (line_a[:, :2] ** 2).sum(axis=1) + (line_b[:, :2] ** 2).sum(axis=1)
    return float(np.sqrt(squares.mean()))


def _normalised(q: Pixels) -> tuple[np.ndarray, np.ndarray]:
    """Return homogeneous coordinates of mean 0 and mean square 2, and the matrix that made them."""
    middle = q.mean(axis=0)
    scale = np.sqrt(2.0 / max(float(((q - middle) ** 2).sum(axis=1).mean()), 1e-30))
    N = np.array([[scale, 0, -scale * middle[0]], [0, scale, -scale * middle[1]], [0, 0, 1.0]])
    return np.concatenate([q, np.ones((len(q), 1))], axis=1) @ N.T, N
