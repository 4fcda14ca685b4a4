"""Sums of the update by one light, see :mod:`~labcal.detect.edges.one_light`, compiled."""

import numpy as np

from labcal.detect.compiled import compiled
from labcal.detect.edges.edge_model import PARAMETERS, STATE, TINY
from labcal.detect.edges.residuals import COVARIANCE, SLOPE_DIFFERENCE, SLOPE_DIFFERENCE_COVARIANCE

_NOISE, _SHARED = SLOPE_DIFFERENCE_COVARIANCE, SLOPE_DIFFERENCE_COVARIANCE + 3
"""First columns of xx xy yy of the differences' noise, and of xu xv yu yv of that with the centre."""


@compiled
def gains(table: np.ndarray, factor: float, scatter: float) -> np.ndarray:
    """Return the gains of centres on slope differences, shape (n, 2, 2).

    `factor` widens the covariances, `scatter` is the variance of the differences beyond their noise.
    """
    found = np.empty((len(table), 2, 2))
    for k in range(len(table)):
        row = table[k]
        xx, xy, yy = (
            factor * row[_NOISE] + scatter,
            factor * row[_NOISE + 1],
            factor * row[_NOISE + 2] + scatter,
        )
        determinant = xx * yy - xy * xy
        for i in range(2):
            u, v = factor * row[_SHARED + 2 * i], factor * row[_SHARED + 2 * i + 1]
            found[k, i, 0] = (u * yy - v * xy) / determinant
            found[k, i, 1] = (v * xx - u * xy) / determinant
    return found


@compiled
def updated_centres(table: np.ndarray, gain: np.ndarray) -> np.ndarray:
    """Return the centres, shape (n, 2), px, moved by gains (n, 2, 2) times the slope differences."""
    found = np.empty((len(table), 2))
    for k in range(len(table)):
        u, v = table[k, SLOPE_DIFFERENCE], table[k, SLOPE_DIFFERENCE + 1]
        for i in range(2):
            found[k, i] = table[k, i] - (gain[k, i, 0] * u + gain[k, i, 1] * v)
    return found


@compiled
def updated_covariances(table: np.ndarray, gain: np.ndarray, factor: float, scatter: float) -> np.ndarray:
    """Return Joseph's form of the covariances of updated centres, (n, 2, 2), px squared; as :func:`gains`."""
    found = np.empty((len(table), 2, 2))
    for k in range(len(table)):
        row, G = table[k], gain[k]
        for i in range(2):
            for j in range(i, 2):
                crossed = G[i, 0] * row[_SHARED + 2 * j] + G[i, 1] * row[_SHARED + 2 * j + 1]
                crossed += G[j, 0] * row[_SHARED + 2 * i] + G[j, 1] * row[_SHARED + 2 * i + 1]
                noise = (G[i, 0] * row[_NOISE] + G[i, 1] * row[_NOISE + 1]) * G[j, 0]
                noise += (G[i, 0] * row[_NOISE + 1] + G[i, 1] * row[_NOISE + 2]) * G[j, 1]
                squares = G[i, 0] * G[j, 0] + G[i, 1] * G[j, 1]
                found[k, i, j] = factor * (row[COVARIANCE + i + j] - crossed + noise) + scatter * squares
        found[k, 1, 0] = found[k, 0, 1]
    return found


@compiled
def parameter_weights(table: np.ndarray, gain: np.ndarray, black: float) -> np.ndarray:
    """Return the weights of a fit's parameters in the updated centre, shape (n, 2, PARAMETERS)."""
    found = np.zeros((len(table), 2, PARAMETERS))
    for k in range(len(table)):
        board, dot = table[k, STATE] - black, table[k, STATE + 3] - black
        scale = max(abs(board), abs(dot), TINY) * max(abs(dot - board), TINY)
        for i in range(2):
            found[k, i, i] = 1.0
            for axis in range(2):
                found[k, i, STATE + 1 + axis] = gain[k, i, axis] * (dot / scale)
                found[k, i, STATE + 4 + axis] = -gain[k, i, axis] * (board / scale)
    return found


@compiled
def light_slopes(table: np.ndarray, board: np.ndarray) -> np.ndarray:
    """Return the slopes of the boards' levels (n) as shares of them, (n, 2), 1/px; fits' are flattened."""
    found = np.empty((len(table), 2))
    for k in range(len(table)):
        u, v, level = table[k, STATE + 1], table[k, STATE + 2], board[k]
        level = max(level, TINY)
        found[k, 0] = (table[k, 2] * u + table[k, 3] * v) / level
        found[k, 1] = (table[k, 3] * u + table[k, 4] * v) / level
    return found
