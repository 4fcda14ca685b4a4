"""The correlation of displacements at two places."""

from dataclasses import dataclass

import numpy as np
from jaxtyping import Float64

from labcal.estimators.gp_field.waves import Waves, squared_distances, weighted_differences


@dataclass(frozen=True)
class FieldKernel:
    """The squared exponential, with one length in the picture and one in depth, and waves where it has some.

    Rasmussen and Williams, "Gaussian Processes for Machine Learning" (2006), section 4.2. Where there are
    waves, the correlation in the picture is multiplied by theirs: ripples of glass have a period, and a
    squared exponential that knows none takes many more points to learn them.

    Attributes
    ----------
    across : float
        Distance in the picture (the first two inputs) over which displacements change; with waves, over which
        their trains decay.
    along : float
        Distance in depth (the third).
    waves : Waves, optional
    """

    across: float
    along: float
    waves: Waves | None = None

    @property
    def wavenumber(self) -> float:
        """Two pi over the period of its waves in the picture, in units of the inputs; 0 without waves."""
        return 0.0 if self.waves is None else self.waves.wavenumber

    @property
    def lengths(self) -> Float64[np.ndarray, "3"]:
        """By input."""
        return np.array([self.across, self.across, self.along])

    def between(
        self, a: Float64[np.ndarray, "n 3"], b: Float64[np.ndarray, "m 3"]
    ) -> Float64[np.ndarray, "n m"]:
        """Return the correlations of places."""
        decay = self.decay(a, b)
        return decay if self.waves is None else np.asarray(decay * self.waves.between(a[:, :2], b[:, :2]))

    def by_wavenumber(
        self, a: Float64[np.ndarray, "n 3"], b: Float64[np.ndarray, "m 3"]
    ) -> Float64[np.ndarray, "n m"]:
        """Return the derivative of the correlations by the logarithm of the wavenumber; 0 without waves."""
        if self.waves is None:
            return np.zeros((len(a), len(b)))
        return np.asarray(self.decay(a, b) * self.waves.by_wavenumber(a[:, :2], b[:, :2]))

    def slopes(
        self,
        a: Float64[np.ndarray, "n 3"],
        b: Float64[np.ndarray, "m 3"],
        weights: Float64[np.ndarray, "m columns"],
    ) -> Float64[np.ndarray, "n columns 3"]:
        """Return derivatives of ``between(a, b) @ weights`` by each input of `a`."""
        slopes = weighted_differences(self.between(a, b), a, b, weights) / self.lengths**2
        if self.waves is not None:
            slopes[..., :2] += self.waves.slopes(a[:, :2], b[:, :2], self.decay(a, b), weights)
        return np.asarray(slopes)

    def decay(
        self, a: Float64[np.ndarray, "n 3"], b: Float64[np.ndarray, "m 3"]
    ) -> Float64[np.ndarray, "n m"]:
        """Return the squared exponential."""
        return np.asarray(np.exp(-0.5 * squared_distances(a / self.lengths, b / self.lengths)))
