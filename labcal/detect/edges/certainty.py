"""Factorised normal equations of a fit with its priors, kept for what is asked of the fit later, compiled."""

import numpy as np

from labcal.detect.compiled import compiled
from labcal.detect.edges.edge_model import PARAMETERS, PRIORS, STATE

_FACTOR = PARAMETERS * PARAMETERS
CERTAINTY = _FACTOR + 2
"""Numbers of a fit: the Cholesky factor, row by row, and the weights of priors on shading and harmonic."""
_HARMONIC = STATE - 2
"""Number of the first parameter of the third harmonic."""


@compiled
def write_certainty(priors: np.ndarray, system: np.ndarray, row: np.ndarray) -> None:
    """Write the priors' weights and the factorised system of a fit into a row of CERTAINTY numbers."""
    for i in range(PARAMETERS):
        for j in range(PARAMETERS):
            row[PARAMETERS * i + j] = system[i, j]
    row[_FACTOR] = priors[0, STATE + 4]
    row[_FACTOR + 1] = priors[PRIORS - 2, _HARMONIC]


@compiled
def factor_of(row: np.ndarray) -> np.ndarray:
    """Return the factor, shape (PARAMETERS, PARAMETERS), of which the lower triangle counts."""
    return row[:_FACTOR].reshape(PARAMETERS, PARAMETERS)


@compiled
def held_by_priors(row: np.ndarray, step: np.ndarray) -> float:
    """Return the sum of the squares of the priors' residuals after a step, shape (PARAMETERS,), from 0."""
    shading = step[STATE + 4] * step[STATE + 4] + step[STATE + 5] * step[STATE + 5]
    harmonic = step[_HARMONIC] * step[_HARMONIC] + step[_HARMONIC + 1] * step[_HARMONIC + 1]
    held: float = row[_FACTOR] * row[_FACTOR] * shading + row[_FACTOR + 1] * row[_FACTOR + 1] * harmonic
    return held
