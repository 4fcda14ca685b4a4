"""The mathematics of lens formulas on Dr.Jit's float64 arrays."""

from dataclasses import dataclass

import drjit as dr

from labcal.cameras.mathematics import Number


@dataclass(frozen=True)
class DrjitMathematics:
    """Mathematics on float64 arrays: float32 would lose the last digits of a 20-megapixel picture."""

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

    def fma(self, a: Number, b: Number, c: Number) -> Number:
        """Return a b + c, rounded once."""
        return dr.fma(a, b, c)

    def polynomial(self, x: Number, coefficients: tuple[Number, ...]) -> Number:
        """Return c0 + c1 x + c2 x^2 + ..., in pairs (Estrin's rule): Horner's waits for every product."""
        terms = list(coefficients)
        while len(terms) > 1:
            pairs = [dr.fma(b, x, a) for a, b in zip(terms[::2], terms[1::2], strict=False)]
            terms = pairs + terms[len(pairs) * 2 :]
            x = x * x
        return terms[0]

    def all_below(self, _a: Number, _limit: float) -> bool:
        """Return False: the value would end the kernel here."""
        return False
