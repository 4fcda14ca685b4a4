"""Correlations of waves of one wavenumber: in all directions alike, or in some."""

from dataclasses import dataclass
from typing import ClassVar

import numpy as np
from jaxtyping import Float64
from scipy.special import j0, j1

_MIDDLE = 1e-8
"""Phase below which the Bessel function over it is taken for its limit."""


@dataclass(frozen=True)
class Spread:
    """The shares of a field's variance that plane waves of some directions have; all are alike if empty.

    Attributes
    ----------
    directions : tuple of float
        Radians, of the normals of the crests.
    shares : tuple of float
        By direction; together 1.
    """

    directions: tuple[float, ...] = ()
    shares: tuple[float, ...] = ()


ALL_ALIKE = Spread()


@dataclass(frozen=True)
class AllDirections:
    """Waves that come from everywhere alike: the Bessel function J0 of the phase (Matern 1960).

    Attributes
    ----------
    wavenumber : float
        Two pi over the period, in units of the inputs.
    """

    wavenumber: float
    spread: ClassVar[Spread] = ALL_ALIKE

    def between(
        self, a: Float64[np.ndarray, "n 2"], b: Float64[np.ndarray, "m 2"]
    ) -> Float64[np.ndarray, "n m"]:
        """Return the correlations."""
        return np.asarray(j0(self._phase(a, b)))

    def by_wavenumber(
        self, a: Float64[np.ndarray, "n 2"], b: Float64[np.ndarray, "m 2"]
    ) -> Float64[np.ndarray, "n m"]:
        """Return their derivatives by the logarithm of the wavenumber."""
        phase = self._phase(a, b)
        return np.asarray(-phase * j1(phase))

    def slopes(
        self,
        a: Float64[np.ndarray, "n 2"],
        b: Float64[np.ndarray, "m 2"],
        decay: Float64[np.ndarray, "n m"],
        weights: Float64[np.ndarray, "m columns"],
    ) -> Float64[np.ndarray, "n columns 2"]:
        """Return the derivatives of ``(decay * between(a, b)) @ weights`` by `a`, `decay` being constant."""
        phase = self._phase(a, b)
        # d J0(k r) / d a = k^2 J1(k r) / (k r) (b - a).
        over_phase = np.where(phase > _MIDDLE, j1(phase) / np.maximum(phase, _MIDDLE), 0.5)
        return weighted_differences(decay * self.wavenumber**2 * over_phase, a, b, weights)

    def _phase(self, a: np.ndarray, b: np.ndarray) -> np.ndarray:
        return np.asarray(self.wavenumber * np.sqrt(squared_distances(a, b)))


@dataclass(frozen=True)
class SomeDirections:
    """Plane waves of independent amplitudes, each with a share of the variance.

    A rolled window has few of them, and a field that knows which needs fewer points than one that
    expects them from everywhere.

    Attributes
    ----------
    wavenumber : float
        Two pi over the period, in units of the inputs.
    spread : Spread
    """

    wavenumber: float
    spread: Spread

    def between(
        self, a: Float64[np.ndarray, "n 2"], b: Float64[np.ndarray, "m 2"]
    ) -> Float64[np.ndarray, "n m"]:
        """Return the correlations."""
        s, t, w = self._phase(a), self._phase(b), np.array(self.spread.shares)
        return np.asarray((np.cos(s) * w) @ np.cos(t).T + (np.sin(s) * w) @ np.sin(t).T)

    def by_wavenumber(
        self, a: Float64[np.ndarray, "n 2"], b: Float64[np.ndarray, "m 2"]
    ) -> Float64[np.ndarray, "n m"]:
        """Return their derivatives by the logarithm of the wavenumber."""
        s, t, w = self._phase(a), self._phase(b), np.array(self.spread.shares)
        by_a = self._sines(s, t, w * s)
        by_b = self._sines(t, s, w * t).T
        return np.asarray(-by_a - by_b)

    def slopes(
        self,
        a: Float64[np.ndarray, "n 2"],
        b: Float64[np.ndarray, "m 2"],
        decay: Float64[np.ndarray, "n m"],
        weights: Float64[np.ndarray, "m columns"],
    ) -> Float64[np.ndarray, "n columns 2"]:
        """Return the derivatives of ``(decay * between(a, b)) @ weights`` by `a`, `decay` being constant."""
        s, t = self._phase(a), self._phase(b)
        along = np.array(self.spread.shares) * self._wavevectors
        return np.stack([-(decay * self._sines(s, t, one)) @ weights for one in along], axis=-1)

    @property
    def _wavevectors(self) -> Float64[np.ndarray, "2 directions"]:
        return self.wavenumber * np.stack([np.cos(self.spread.directions), np.sin(self.spread.directions)])

    def _phase(self, x: np.ndarray) -> np.ndarray:
        return np.asarray(x @ self._wavevectors)

    @staticmethod
    def _sines(s: np.ndarray, t: np.ndarray, weights: np.ndarray) -> np.ndarray:
        """Return the sums over directions of ``weights * sin(s - t)`` of all pairs."""
        return np.asarray((weights * np.sin(s)) @ np.cos(t).T - (weights * np.cos(s)) @ np.sin(t).T)


Waves = AllDirections | SomeDirections
"""The correlation of displacements by waves at two places of the picture; 1 at the same place."""


def waves_of(wavenumber: float, spread: Spread) -> Waves:
    """Return waves of a wavenumber and shares of directions."""
    return SomeDirections(wavenumber, spread) if spread.directions else AllDirections(wavenumber)


def squared_distances(
    x: Float64[np.ndarray, "n inputs"], y: Float64[np.ndarray, "m inputs"]
) -> Float64[np.ndarray, "n m"]:
    """Return the squared distances of all pairs."""
    square = (x**2).sum(axis=1)[:, None] + (y**2).sum(axis=1) - 2.0 * (x @ y.T)
    return np.asarray(np.maximum(square, 0.0))


def weighted_differences(
    slope: Float64[np.ndarray, "n m"],
    a: Float64[np.ndarray, "n inputs"],
    b: Float64[np.ndarray, "m inputs"],
    weights: Float64[np.ndarray, "m columns"],
) -> Float64[np.ndarray, "n columns inputs"]:
    """Return the sums of ``slope (b - a)``, weighted, without an array of n x m x inputs."""
    towards = np.stack([slope @ (weights * column[:, None]) for column in b.T], axis=-1)
    here = (slope @ weights)[:, :, None] * a[:, None, :]
    return np.asarray(towards - here)
