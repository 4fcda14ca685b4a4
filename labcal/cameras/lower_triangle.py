"""The lower triangle of a covariance, as it stands in files."""

from collections.abc import Sequence
from typing import Annotated

import numpy as np
from jaxtyping import Float64
from pydantic import Field

from labcal.bounds import MOST_PARAMETER_VARIANCE

MOST_PARAMETERS = 400
"""Of a rig: those of twenty cameras."""
_ROUNDING = 1e-6
"""Of the least eigenvalue of correlations, below which they are none."""

Element = Annotated[
    float, Field(ge=-MOST_PARAMETER_VARIANCE, le=MOST_PARAMETER_VARIANCE, allow_inf_nan=False)
]
"""Of a covariance."""


def lower_triangle(covariance: Float64[np.ndarray, "n n"]) -> tuple[tuple[float, ...], ...]:
    """Return the lower triangle of a covariance, a tuple for each row."""
    return tuple(tuple(row[: number + 1].tolist()) for number, row in enumerate(covariance))


def full_matrix(lower: Sequence[Sequence[float]]) -> Float64[np.ndarray, "n n"]:
    """Return a covariance of its lower triangle as a full matrix."""
    count = len(lower)
    matrix = np.zeros((count, count))
    matrix[np.tril_indices(count)] = [value for row in lower for value in row]
    return matrix + np.tril(matrix, -1).T


def require_covariance(lower: Sequence[Sequence[float]], count: int) -> None:
    """Raise unless rows are the lower triangle of a covariance of so many parameters.

    Raises
    ------
    ValueError
        They are not; the message speaks of ``lower``, as pydantic's models name it.
    """
    if [len(row) for row in lower] != list(range(1, count + 1)):
        raise ValueError(f"'lower' has not the rows of a lower triangle of {count} parameters")
    variance = np.array([row[-1] for row in lower])
    if not (variance >= 0.0).all():
        raise ValueError("'lower' has a negative variance")
    scale = np.sqrt(np.where(variance > 0.0, variance, 1.0))
    correlation = full_matrix(lower) / scale[:, None] / scale
    if not np.isfinite(correlation).all() or not np.linalg.eigvalsh(correlation)[0] > -_ROUNDING * count:
        raise ValueError("'lower' is no covariance: some combination has a negative variance")
