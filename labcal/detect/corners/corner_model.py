"""The picture of one corner of a chessboard: two blurred edges that cross, with the light's slope."""

from dataclasses import dataclass

import numpy as np
from scipy.special import erf, ndtr, owens_t

PARAMETERS = 10
"""Corner 2, angles of the edges' normals 2, blurs 2, mean, half step, slope of the light 2."""
_MOST_OBLIQUE = 0.999  # cosine of the angle between the edges
_TINY = 1e-9


@dataclass(frozen=True)
class CornerPixels:
    """The pixels of a fit: their mask in their rectangle, offsets (2, n) from its start, and grey values."""

    mask: np.ndarray
    offset: np.ndarray
    value: np.ndarray
    gap: np.ndarray
    """(2,), from the corner's edges to those of the markers, px."""


@dataclass(frozen=True)
class LinearisedCorner:
    """Residuals and derivatives by corner 2, angles of normals 2, blurs 2, mean, half step, slope 2."""

    residual: np.ndarray
    jacobian: np.ndarray
    board: np.ndarray
    """The modelled pattern, from -1 (black) to 1 (white)."""
    off_edges: np.ndarray
    """The smaller distance of every pixel from the two edges, in blurs."""


@dataclass(frozen=True)
class _Board:
    """A blurred chessboard, and its derivatives by the two distances and by the correlation."""

    value: np.ndarray
    by_first: np.ndarray
    by_second: np.ndarray
    by_correlation: np.ndarray


def linearise(state: np.ndarray, window: CornerPixels) -> LinearisedCorner:
    """Return residuals and derivatives at a state.

    The formula stands at :func:`~labcal.detect.corners.corner_fit.fit_corner`.

    Parameters
    ----------
    state : ndarray, shape (PARAMETERS,)
    window : CornerPixels
    """
    blur, mean, step, slope = state[4:6, None], state[6], state[7], state[8:]
    d = window.offset - state[:2, None]
    cos, sin = np.cos(state[2:4]), np.sin(state[2:4])
    u = (cos[:, None] * d[0] + sin[:, None] * d[1]) / blur
    across = cos[:, None] * d[1] - sin[:, None] * d[0]
    correlation = np.clip(np.cos(state[2] - state[3]), -_MOST_OBLIQUE, _MOST_OBLIQUE)
    board = _blurred_board(u, float(correlation))
    light = 1 + slope @ window.offset
    dark = 2 * (ndtr(np.abs(u) - window.gap[:, None] / blur)).prod(axis=0) * (u[0] * u[1] > 0)
    plain = mean + step * (board.value - dark)
    first, second = light * step / blur * np.stack([board.by_first, board.by_second])
    turn = light * step * board.by_correlation * np.sin(state[2] - state[3])
    jacobian = np.stack(
        [
            -first * cos[0] - second * cos[1],
            -first * sin[0] - second * sin[1],
            first * across[0] - turn,
            second * across[1] + turn,
            -first * u[0],
            -second * u[1],
            light,
            light * (board.value - dark),
            window.offset[0] * plain,
            window.offset[1] * plain,
        ]
    )
    return LinearisedCorner(window.value - light * plain, jacobian, board.value - dark, np.abs(u).min(axis=0))


def _blurred_board(u: np.ndarray, correlation: float) -> _Board:
    """Return a blurred chessboard at distances from its edges, in blurs, shape (2, n)."""
    a, b = np.where(np.abs(u) < _TINY, _TINY, u)
    other = np.sqrt(1 - correlation**2)
    beside_a, beside_b = (b - correlation * a) / other, (a - correlation * b) / other
    value = 1 - 4 * owens_t(a, beside_a / a) - 4 * owens_t(b, beside_b / b) - 2 * (a * b < 0)
    exponent = (a * a - 2 * correlation * a * b + b * b) / (2 * other**2)
    return _Board(
        value=value,
        by_first=np.sqrt(2 / np.pi) * np.exp(-0.5 * a * a) * erf(beside_a / np.sqrt(2)),
        by_second=np.sqrt(2 / np.pi) * np.exp(-0.5 * b * b) * erf(beside_b / np.sqrt(2)),
        by_correlation=2 / (np.pi * other) * np.exp(-exponent),
    )
