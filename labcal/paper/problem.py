"""The data of an experiment: training data and separate test data."""

from dataclasses import dataclass

import numpy as np
from jaxtyping import Float64


@dataclass(frozen=True)
class Problem:
    """Pixels (or image coordinates) and their outputs; no test point is a training point."""

    X: Float64[np.ndarray, "n inputs"]
    Y: Float64[np.ndarray, "n outputs"]
    """X, Y and Z in mm, then whatever else the experiment asks for."""
    X_test: Float64[np.ndarray, "tested inputs"]
    Y_test: Float64[np.ndarray, "tested outputs"]
