"""Uncertainty of corners whose edges have no blur: between pixels an edge leaves no trace of its place."""

from collections.abc import Sequence

import numpy as np
from jaxtyping import Float64

from labcal.detect.corners.corner_fit import SettledCorner

_AT_LEAST = 1.001
"""A blur up to so many times the least one is bound by it."""
_NEAR_PX = 1.0
"""Distance from an edge of the pixels that it can run through."""
_INTERMEDIATE = 0.8
"""Of the step from the mean to black or white: pixels within are partly covered."""
_UNSEEN = 1.0 / 12.0
"""Variance of the place of an edge between two pixels, uniform over a pixel, px squared."""
_COVERED = 0.06**2
"""The same where pixels are partly covered: what the blurred model makes of a covered share, px squared."""


def hard_edge_covariances(fits: Sequence[SettledCorner | None], least_blur: float) -> np.ndarray:
    """Return the covariances that hard edges add to the places of corners, px squared, shape (n, 2, 2).

    They are zero where the edges are blurred, and where there is no fit. A photograph always is; drawings,
    rasters and thresholded pictures are not.

    Parameters
    ----------
    fits : sequence of SettledCorner or None
    least_blur : float
        The least blur of a fit, px.
    """
    found = np.zeros((len(fits), 2, 2))
    for k, fit in enumerate(fits):
        if fit is not None and min(fit.state.item(4), fit.state.item(5)) <= _AT_LEAST * least_blur:
            found[k] = _hard_edge_covariance(fit, least_blur)
    return found


def _hard_edge_covariance(fit: SettledCorner, least_blur: float) -> np.ndarray:
    """Return the covariance of one corner's place, of whose edges at least one is hard.

    An edge that is turned against the pixels runs through m of them across its length, evenly: its mean place
    is then off by 1 / m.
    """
    window = fit.window
    variances, offset = np.zeros(2), window.offset - fit.state[:2, None]
    normals = edge_normals(fit)
    level = np.abs(window.value - fit.state[6]) / abs(float(fit.state[7]))
    for edge, (blur, normal) in enumerate(zip(fit.state[4:6].tolist(), normals, strict=True)):
        if blur > _AT_LEAST * least_blur:
            continue
        near = np.abs(normal @ offset) < _NEAR_PX
        # Pixels at the other edge say nothing of this one.
        near &= np.abs(normals[1 - edge] @ offset) > 2.0 * _NEAR_PX
        covered = bool((level[near] < _INTERMEDIATE).any())
        variances[edge] = (_COVERED if covered else _UNSEEN) / pixels_crossed(normal, offset[:, near]) ** 2
    return place_covariance(normals, variances)


def edge_normals(fit: SettledCorner) -> Float64[np.ndarray, "2 2"]:
    """Return the normals of both edges, a row each."""
    return np.stack([np.cos(fit.state[2:4]), np.sin(fit.state[2:4])], axis=1)


def pixels_crossed(normal: np.ndarray, offset: np.ndarray) -> float:
    """Return through how many pixels, between their middles, an edge runs across; 1 at least.

    Parameters
    ----------
    normal : ndarray, shape (2,)
        Of the edge.
    offset : ndarray, shape (2, n)
        Of the pixels along it, px; none is an edge of no length.
    """
    along = np.array([-normal[1], normal[0]]) @ offset
    length = float(np.ptp(along)) if len(along) else 0.0
    return max(1.0, length * float(np.abs(normal).min() / np.abs(normal).max()))


def place_covariance(normals: np.ndarray, variances: np.ndarray) -> Float64[np.ndarray, "2 2"]:
    """Return the covariance of the place where two edges cross, of variances along their normals."""
    if not variances.any():
        return np.zeros((2, 2))
    inverse = np.linalg.inv(normals)
    return np.asarray((inverse * variances) @ inverse.T)
