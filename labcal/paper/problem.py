"""What an experiment gives a solver: data to learn from, and other data to be tested on."""

from dataclasses import dataclass

import numpy as np
from jaxtyping import Float64


@dataclass(frozen=True)
class Problem:
    """Pixels (or image coordinates) and what belongs to them; no test point is a trained point."""

    X: Float64[np.ndarray, "n inputs"]
    Y: Float64[np.ndarray, "n outputs"]
    """X, Y and Z in mm, then whatever else the experiment asks for."""
    X_test: Float64[np.ndarray, "tested inputs"]
    Y_test: Float64[np.ndarray, "tested outputs"]
