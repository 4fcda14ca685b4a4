"""The picture of one corner, of a chessboard or of a tag: two blurred edges, with the light's slope."""

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np
from scipy.special import erf, ndtr, owens_t

PARAMETERS = 10
"""Corner 2, angles of the edges' normals 2, blurs 2, mean, half step, slope of the light 2."""
_MOST_OBLIQUE = 0.999  # cosine of the angle between the edges
_TINY = 1e-9


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
class Blurred:
    """A blurred pattern, and its derivatives by the two distances and by the correlation."""

    value: np.ndarray
    by_first: np.ndarray
    by_second: np.ndarray
    by_correlation: np.ndarray


Pattern = Callable[[np.ndarray, float, np.ndarray], Blurred]
"""A pattern of two edges, of distances from them (2, n), the correlation of their blurs, and distances of
markers' edges (2, 1); all distances are in blurs."""


def linearise(state: np.ndarray, window: "CornerPixels") -> LinearisedCorner:
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
    board = window.pattern(u, float(correlation), window.gap[:, None] / blur)
    light = 1 + slope @ window.offset
    plain = mean + step * board.value
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
            light * board.value,
            window.offset[0] * plain,
            window.offset[1] * plain,
        ]
    )
    return LinearisedCorner(window.value - light * plain, jacobian, board.value, np.abs(u).min(axis=0))


def chessboard(u: np.ndarray, correlation: float, gap: np.ndarray) -> Blurred:
    """Return a blurred chessboard whose markers' borders spread darkness into white squares."""
    board = _blurred_board(u, correlation)
    dark = 2 * (ndtr(np.abs(u) - gap)).prod(axis=0) * (u[0] * u[1] > 0)
    return Blurred(board.value - dark, board.by_first, board.by_second, board.by_correlation)


def wedge(u: np.ndarray, correlation: float, gap: np.ndarray) -> Blurred:  # noqa: ARG001 -- as of a chessboard
    """Return a blurred black wedge on white, where both distances are positive, from -1 to 1.

    The probability that two correlated normal variables exceed two limits follows from the chessboard's
    expectation of the product of their signs.
    """
    board = _blurred_board(u, correlation)
    first, second = np.exp(-0.5 * u * u) / np.sqrt(2.0 * np.pi)
    value = 1.5 - 0.5 * board.value - ndtr(u).sum(axis=0)
    return Blurred(
        value, -0.5 * board.by_first - first, -0.5 * board.by_second - second, -0.5 * board.by_correlation
    )


@dataclass(frozen=True)
class CornerPixels:
    """The pixels of a fit: their mask in their rectangle, offsets (2, n) from its start, and grey values."""

    mask: np.ndarray
    offset: np.ndarray
    value: np.ndarray
    gap: np.ndarray
    """(2,), from the corner's edges to those of the markers, px."""
    pattern: Pattern = chessboard


def _blurred_board(u: np.ndarray, correlation: float) -> Blurred:
    """Return a blurred chessboard at distances from its edges, in blurs, shape (2, n)."""
    a, b = np.where(np.abs(u) < _TINY, _TINY, u)
    other = np.sqrt(1 - correlation**2)
    beside_a, beside_b = (b - correlation * a) / other, (a - correlation * b) / other
    value = 1 - 4 * owens_t(a, beside_a / a) - 4 * owens_t(b, beside_b / b) - 2 * (a * b < 0)
    exponent = (a * a - 2 * correlation * a * b + b * b) / (2 * other**2)
    return Blurred(
        value=value,
        by_first=np.sqrt(2 / np.pi) * np.exp(-0.5 * a * a) * erf(beside_a / np.sqrt(2)),
        by_second=np.sqrt(2 / np.pi) * np.exp(-0.5 * b * b) * erf(beside_b / np.sqrt(2)),
        by_correlation=2 / (np.pi * other) * np.exp(-exponent),
    )
