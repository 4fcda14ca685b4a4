"""The mathematics of lens formulas on Dr.Jit's float32 arrays."""

import drjit as dr

from labcal.cameras.mathematics import Number


class DrjitMathematics:
    """float32 arrays of Dr.Jit."""

    newton_steps = 6
    tolerance = 1e-6

    def sqrt(self, a: Number) -> Number:
        """Return the square root."""
        return dr.sqrt(a)

    def where(self, condition: Number, a: Number, b: Number) -> Number:
        """Return `a` where the condition holds, else `b`."""
        return dr.select(condition, a, b)


DRJIT = DrjitMathematics()
