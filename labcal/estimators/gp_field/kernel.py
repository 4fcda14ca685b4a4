"""The correlation of displacements at two places."""

from dataclasses import dataclass

import numpy as np
from jaxtyping import Float64


@dataclass(frozen=True)
class FieldKernel:
    """The squared exponential, with one length in the picture and one in depth.

    Rasmussen and Williams, "Gaussian Processes for Machine Learning" (2006), section 4.2.

    Attributes
    ----------
    across : float
        Distance in the picture (the first two inputs) over which displacements change.
    along : float
        Distance in depth (the third).
    """

    across: float
    along: float

    @property
    def lengths(self) -> Float64[np.ndarray, "3"]:
        """By input."""
        return np.array([self.across, self.across, self.along])

    def between(
        self, a: Float64[np.ndarray, "n 3"], b: Float64[np.ndarray, "m 3"]
    ) -> Float64[np.ndarray, "n m"]:
        """Return the correlations of places."""
        x, y = a / self.lengths, b / self.lengths
        square = (x**2).sum(axis=1)[:, None] + (y**2).sum(axis=1) - 2.0 * (x @ y.T)
        return np.asarray(np.exp(-0.5 * np.maximum(square, 0.0)))

    def slopes(
        self,
        a: Float64[np.ndarray, "n 3"],
        b: Float64[np.ndarray, "m 3"],
        weights: Float64[np.ndarray, "m columns"],
    ) -> Float64[np.ndarray, "n columns 3"]:
        """Return derivatives of ``between(a, b) @ weights`` by each input of `a`."""
        correlation = self.between(a, b)
        # d k / d a = k (b - a) / length^2, summed without an array of n x m x inputs.
        towards = np.stack([correlation @ (weights * column[:, None]) for column in b.T], axis=-1)
        here = (correlation @ weights)[:, :, None] * a[:, None, :]
        return np.asarray((towards - here) / self.lengths**2)
