"""The correlation of displacements at two places."""

from dataclasses import dataclass

import numpy as np
from jaxtyping import Float64
from scipy.special import j0, j1

_MIDDLE = 1e-8
"""Phase below which the Bessel function over it is taken for its limit."""


@dataclass(frozen=True)
class FieldKernel:
    """The squared exponential, with one length in the picture and one in depth, and waves where it has some.

    Rasmussen and Williams, "Gaussian Processes for Machine Learning" (2006), section 4.2. With a wavenumber k
    the correlation in the picture is multiplied by the Bessel function ``J0(k r)``, that of waves of this
    wavenumber in all directions (Matern 1960): ripples of glass have a period, and a squared exponential
    that knows none takes many more points to learn them.

    Attributes
    ----------
    across : float
        Distance in the picture (the first two inputs) over which displacements change; with waves, over which
        their trains decay.
    along : float
        Distance in depth (the third).
    wavenumber : float
        Two pi over the period of waves in the picture, in units of the inputs; 0 for none.
    """

    across: float
    along: float
    wavenumber: float = 0.0

    @property
    def lengths(self) -> Float64[np.ndarray, "3"]:
        """By input."""
        return np.array([self.across, self.across, self.along])

    def between(
        self, a: Float64[np.ndarray, "n 3"], b: Float64[np.ndarray, "m 3"]
    ) -> Float64[np.ndarray, "n m"]:
        """Return the correlations of places."""
        decay = self._decay(a, b)
        return decay if self.wavenumber == 0.0 else np.asarray(decay * j0(self._phase(a, b)))

    def by_wavenumber(
        self, a: Float64[np.ndarray, "n 3"], b: Float64[np.ndarray, "m 3"]
    ) -> Float64[np.ndarray, "n m"]:
        """Return the derivative of the correlations by the logarithm of the wavenumber."""
        phase = self._phase(a, b)
        return np.asarray(-self._decay(a, b) * phase * j1(phase))

    def slopes(
        self,
        a: Float64[np.ndarray, "n 3"],
        b: Float64[np.ndarray, "m 3"],
        weights: Float64[np.ndarray, "m columns"],
    ) -> Float64[np.ndarray, "n columns 3"]:
        """Return derivatives of ``between(a, b) @ weights`` by each input of `a`."""
        if self.wavenumber == 0.0:
            return np.asarray(self._weighted(self.between(a, b), a, b, weights) / self.lengths**2)
        decay, phase = self._decay(a, b), self._phase(a, b)
        waves = decay * j0(phase)
        # d J0(k r) / d a = k^2 J1(k r) / (k r) (b - a).
        ripple = self.wavenumber**2 * np.where(phase > _MIDDLE, j1(phase) / np.maximum(phase, _MIDDLE), 0.5)
        across = self._weighted(waves / self.across**2 + decay * ripple, a, b, weights)
        along = self._weighted(waves / self.along**2, a, b, weights)
        return np.concatenate([across[..., :2], along[..., 2:]], axis=-1)

    @staticmethod
    def _weighted(
        slope: Float64[np.ndarray, "n m"], a: np.ndarray, b: np.ndarray, weights: np.ndarray
    ) -> np.ndarray:
        """Return the sums of ``slope (b - a)``, weighted, without an array of n x m x inputs."""
        towards = np.stack([slope @ (weights * column[:, None]) for column in b.T], axis=-1)
        here = (slope @ weights)[:, :, None] * a[:, None, :]
        return np.asarray(towards - here)

    def _decay(self, a: np.ndarray, b: np.ndarray) -> np.ndarray:
        """Return the squared exponential."""
        return np.asarray(np.exp(-0.5 * _squares(a / self.lengths, b / self.lengths)))

    def _phase(self, a: np.ndarray, b: np.ndarray) -> np.ndarray:
        """Return the distances in the picture times the wavenumber."""
        return np.asarray(self.wavenumber * np.sqrt(_squares(a[:, :2], b[:, :2])))


def _squares(x: np.ndarray, y: np.ndarray) -> np.ndarray:
    """Return the squared distances of all pairs."""
    square = (x**2).sum(axis=1)[:, None] + (y**2).sum(axis=1) - 2.0 * (x @ y.T)
    return np.asarray(np.maximum(square, 0.0))
