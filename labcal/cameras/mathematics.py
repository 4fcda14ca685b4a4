"""The mathematics a lens formula may use, so that NumPy and Dr.Jit run the same lines."""

from typing import Any, Protocol, runtime_checkable

import numpy as np

Number = Any
"""A NumPy array, a Dr.Jit array or a plain float: whatever takes part in ``+ - * /`` and comparison."""


@runtime_checkable  # so that tests can check annotations
class Mathematics(Protocol):
    """A namespace of functions on one kind of number."""

    newton_steps: int
    """Newton steps after which an inverse that converges has reached this number's precision."""
    tolerance: float
    """Residual, in units of the focal length, below which an inverse counts as found."""

    def sqrt(self, a: Number) -> Number:
        """Return the square root."""

    def where(self, condition: Number, a: Number, b: Number) -> Number:
        """Return `a` where the condition holds, else `b`."""


class NumpyMathematics:
    """float64 arrays."""

    newton_steps = 16
    tolerance = 1e-11

    def sqrt(self, a: Number) -> Number:
        """Return the square root."""
        return np.sqrt(a)

    def where(self, condition: Number, a: Number, b: Number) -> Number:
        """Return `a` where the condition holds, else `b`."""
        return np.where(condition, a, b)


NUMPY = NumpyMathematics()
