"""Edges of a board as a lens bends them: their run beyond a straight line, taken from the pixels of a fit."""

import numpy as np

from labcal.arrays import Pixels
from labcal.detect.compiled import compiled
from labcal.detect.corners.board_lens import BoardLens

_AT = np.array([-1.0, -0.5, 0.5, 1.0])
"""Places along an edge that tell its run, in its reach."""
_TERMS = 7


def no_runs(n: int) -> np.ndarray:
    """Return the runs of straight edges of n corners, see :func:`edge_runs`."""
    return np.zeros((n, 2, _TERMS))


def edge_runs(lens: BoardLens, board: np.ndarray, q: Pixels, reach: tuple[float, float]) -> np.ndarray:
    """Return how edges run beside their tangents at corners, shape (n, 2, 7), along x and along y.

    Each has the direction of the tangent, what moves a pixel across this edge by one pixel and along the
    other edge only, and the coefficients of the second to fourth powers of the distance along the tangent.

    Parameters
    ----------
    lens : BoardLens
    board : ndarray, shape (n, 2)
        The corners' places on the board, in squares.
    q : ndarray, shape (n, 2)
        And in the picture, about.
    reach : (float, float)
        How far the edges are seen, in squares and in px.
    """
    share, most = reach
    q = lens.in_picture(board, q)
    to_px = np.linalg.inv(lens.on_board(q)[1])
    runs = no_runs(len(q))
    tangents = to_px / np.linalg.norm(to_px, axis=1, keepdims=True)
    normals = np.stack([-tangents[:, 1], tangents[:, 0]], axis=1)
    for axis in (0, 1):
        length = np.minimum(share, most / np.linalg.norm(to_px[..., axis], axis=1))
        along = _AT[:, None] * length
        beside = np.repeat(board[None], len(_AT), axis=0).astype(np.float64)
        beside[..., axis] += along
        near = q + along[..., None] * to_px[..., axis]
        seen = lens.in_picture(beside.reshape(-1, 2), near.reshape(-1, 2)).reshape(near.shape) - q
        t, u = ((seen * some[..., axis]).sum(axis=2).T for some in (tangents, normals))
        scale = np.abs(t).max(axis=1, keepdims=True)
        powers = (t / scale)[..., None] ** np.arange(1, len(_AT) + 1)
        terms = np.linalg.solve(powers, u[..., None])[:, 1:, 0] / scale ** np.arange(2, len(_AT) + 1)
        runs[:, axis, :2], runs[:, axis, 4:] = tangents[..., axis], terms
    # Rows of the inverse: what moves a pixel across one edge, and not across the other.
    runs[:, :, 2:4] = np.linalg.inv(normals.transpose(0, 2, 1)).transpose(0, 2, 1)
    return runs


def run_bends(runs: np.ndarray) -> np.ndarray:
    """Return the vectors of curvature of edges with these runs at their corners, 1/px, shape (n, 2, 2)."""
    normals = np.stack([-runs[..., 1], runs[..., 0]], axis=-1)
    return np.asarray(2.0 * runs[..., 4:5] * normals)


@compiled
def straighten(offset: np.ndarray, run: np.ndarray) -> None:
    """Move the pixels (2, n) of a corner, in place, as if its edges were straight; run (2, 7)."""
    for k in range(offset.shape[1]):
        x, y = offset[0, k], offset[1, k]
        for axis in range(2):
            t = run[axis, 0] * x + run[axis, 1] * y
            u = t * t * (run[axis, 4] + t * (run[axis, 5] + t * run[axis, 6]))
            offset[0, k] -= run[axis, 2] * u
            offset[1, k] -= run[axis, 3] * u
