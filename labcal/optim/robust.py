"""Cost functions of residuals: squares, or a robust loss that gives outliers less weight."""

from dataclasses import dataclass
from typing import Protocol, runtime_checkable

import numpy as np
from jaxtyping import Float64

from labcal.errors import InputError


@runtime_checkable  # so that tests can check annotations
class Loss(Protocol):
    """A cost of squared residuals, each in units of its variance."""

    def cost(self, square: Float64[np.ndarray, " n"]) -> Float64[np.ndarray, " n"]:
        """Return the cost of each residual."""

    def weight(self, square: Float64[np.ndarray, " n"]) -> Float64[np.ndarray, " n"]:
        """Return the slope of the cost, by which a square counts in the normal equations."""


@dataclass(frozen=True)
class Squares:
    """Plain least squares."""

    def cost(self, square: Float64[np.ndarray, " n"]) -> Float64[np.ndarray, " n"]:
        """Return the squares."""
        return square

    def weight(self, square: Float64[np.ndarray, " n"]) -> Float64[np.ndarray, " n"]:
        """Return ones."""
        return np.ones_like(square)


SQUARES = Squares()


@dataclass(frozen=True)
class Huber:
    """Quadratic up to a bound, linear beyond it (Huber 1964).

    Attributes
    ----------
    bound : float
        In standard deviations. A residual of two components exceeds 3 with a probability of 0.011.

    Raises
    ------
    InputError
        The bound is not positive.
    """

    bound: float = 3.0

    def __post_init__(self) -> None:
        """Refuse a bound that is not positive."""
        if not self.bound > 0:
            raise InputError(f"A loss needs a bound above 0 standard deviations, but got {self.bound:g}.")

    def cost(self, square: Float64[np.ndarray, " n"]) -> Float64[np.ndarray, " n"]:
        """Return squares, and ``2 bound |r| - bound^2`` beyond the bound."""
        beyond = 2.0 * self.bound * np.sqrt(square) - self.bound**2
        return np.where(square <= self.bound**2, square, beyond)

    def weight(self, square: Float64[np.ndarray, " n"]) -> Float64[np.ndarray, " n"]:
        """Return 1, and ``bound / |r|`` beyond the bound."""
        return np.asarray(self.bound / np.sqrt(np.maximum(square, self.bound**2)))
