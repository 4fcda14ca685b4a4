"""The mathematics of lens formulas on Dr.Jit's float64 arrays."""

from dataclasses import dataclass

import drjit as dr

from labcal.cameras.mathematics import Number


@dataclass(frozen=True)
class DrjitMathematics:
    """float64 arrays of Dr.Jit: in single precision a picture of 20 megapixels would lose its last digits."""

    newton_steps: int
    settled: float = 1e-4

    def sqrt(self, a: Number) -> Number:
        """Return the square root."""
        return dr.sqrt(a)

    def sin(self, a: Number) -> Number:
        """Return the sine of an angle in radians."""
        return dr.sin(a)

    def cos(self, a: Number) -> Number:
        """Return the cosine of an angle in radians."""
        return dr.cos(a)

    def atan2(self, y: Number, x: Number) -> Number:
        """Return the angle of (x, y), radians."""
        return dr.atan2(y, x)

    def where(self, condition: Number, a: Number, b: Number) -> Number:
        """Return `a` where the condition holds, else `b`."""
        return dr.select(condition, a, b)

    def all_below(self, _a: Number, _limit: float) -> bool:
        """Return False: to know it would end the kernel here."""
        return False
