"""The mathematics a lens formula may use, so that NumPy and Dr.Jit run the same lines."""

from dataclasses import dataclass
from math import factorial
from typing import Any, Protocol, runtime_checkable

import numpy as np

Number = Any
"""A NumPy array, a Dr.Jit array, a dual number or a plain float: what takes part in ``+ - * /`` and ``<``."""


@runtime_checkable  # so that tests can check annotations
class Mathematics(Protocol):
    """A namespace of functions on one kind of number."""

    @property
    def newton_steps(self) -> int:
        """Newton steps that an inverse may take."""

    @property
    def settled(self) -> float:
        """Length of Newton's last step, at unit focal length, from which on an inverse counts as found.

        Newton squares the error in every step, so what is left after it is far less than this.
        """

    def sqrt(self, a: Number) -> Number:
        """Return the square root."""

    def sin(self, a: Number) -> Number:
        """Return the sine of an angle in radians."""

    def cos(self, a: Number) -> Number:
        """Return the cosine of an angle in radians."""

    def atan2(self, y: Number, x: Number) -> Number:
        """Return the angle of (x, y), radians."""

    def where(self, condition: Number, a: Number, b: Number) -> Number:
        """Return `a` where the condition holds, else `b`."""

    def fma(self, a: Number, b: Number, c: Number) -> Number:
        """Return a b + c, rounded once where the processor can."""

    def polynomial(self, x: Number, coefficients: tuple[Number, ...]) -> Number:
        """Return c0 + c1 x + c2 x^2 + ..., at least two coefficients."""

    def all_below(self, a: Number, limit: float) -> bool:
        """Return whether it is known that no element exceeds the limit; never, where that would cost."""


@dataclass(frozen=True)
class NumpyMathematics:
    """float64 arrays."""

    newton_steps: int = 24
    settled: float = 1e-8

    def sqrt(self, a: Number) -> Number:
        """Return the square root."""
        return np.sqrt(a)

    def sin(self, a: Number) -> Number:
        """Return the sine of an angle in radians."""
        return np.sin(a)

    def cos(self, a: Number) -> Number:
        """Return the cosine of an angle in radians."""
        return np.cos(a)

    def atan2(self, y: Number, x: Number) -> Number:
        """Return the angle of (x, y), radians."""
        return np.arctan2(y, x)

    def where(self, condition: Number, a: Number, b: Number) -> Number:
        """Return `a` where the condition holds, else `b`."""
        return np.where(condition, a, b)

    def fma(self, a: Number, b: Number, c: Number) -> Number:
        """Return a b + c."""
        return a * b + c

    def polynomial(self, x: Number, coefficients: tuple[Number, ...]) -> Number:
        """Return c0 + c1 x + c2 x^2 + ..., by Horner's rule."""
        value = coefficients[-1]
        for coefficient in coefficients[-2::-1]:
            value = value * x + coefficient
        return value

    def all_below(self, a: Number, limit: float) -> bool:
        """Return whether no element exceeds the limit; NaN does not."""
        return not bool(np.any(a > limit))


NUMPY = NumpyMathematics()

_ENTIRE = 16
"""Terms that give cosine and sine over angle to the last digit up to an angle of pi."""
_COSINE = tuple((-1.0) ** n / factorial(2 * n) for n in range(_ENTIRE))
_SINC = tuple((-1.0) ** n / factorial(2 * n + 1) for n in range(_ENTIRE))


def cosine_and_sinc(m: Mathematics, angle2: Number) -> tuple[Number, Number]:
    """Return the cosine of an angle up to pi, and its sine over it, from the angle squared.

    Both are smooth in the square, so that nothing happens on the axis, where the angle is 0.
    """
    return m.polynomial(angle2, _COSINE), m.polynomial(angle2, _SINC)
