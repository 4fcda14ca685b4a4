"""Dual numbers: any lens formula gives its own exact derivatives (forward-mode differentiation).

A dual number is a value with its slopes along a few directions; arithmetic carries both. See Griewank and
Walther, "Evaluating Derivatives" (2008), chapter 3. A slope that is the plain float 0.0 costs nothing.
"""

from collections.abc import Callable
from dataclasses import dataclass

from labcal.cameras.mathematics import Mathematics, Number

Slopes = tuple[Number, ...]


def _scaled(slope: Number, factor: Number) -> Number:
    """Return slope times factor, and a plain zero for a plain zero."""
    return 0.0 if _is_zero(slope) else slope * factor


def _sum(a: Number, b: Number) -> Number:
    """Return the sum of two slopes."""
    if _is_zero(a):
        return b
    return a if _is_zero(b) else a + b


def _is_zero(slope: Number) -> bool:
    return type(slope) is float and slope == 0.0


class Dual:
    """A value and its slopes.

    Parameters
    ----------
    value : number
    slopes : tuple of number
        Derivatives along each direction; all dual numbers of a formula have the same directions.
    """

    __array_ufunc__ = None  # a NumPy array on the left leaves the operation to this class
    __slots__ = ("slopes", "value")

    def __init__(self, value: Number, slopes: Slopes) -> None:
        self.value, self.slopes = value, slopes

    def mapped(self, value: Number, change: Callable[[Number], Number]) -> "Dual":
        """Return another value whose slopes are these after a change."""
        return Dual(value, tuple(change(slope) for slope in self.slopes))

    def __neg__(self) -> "Dual":
        return self.mapped(-self.value, lambda slope: _scaled(slope, -1.0))

    def _plus(self, other: Number) -> "Dual":
        if not isinstance(other, Dual):
            return Dual(self.value + other, self.slopes)
        slopes = tuple(_sum(a, b) for a, b in zip(self.slopes, other.slopes, strict=True))
        return Dual(self.value + other.value, slopes)

    __add__ = __radd__ = _plus

    def __sub__(self, other: Number) -> "Dual":
        return self._plus(-other)

    def __rsub__(self, other: Number) -> "Dual":
        return (-self)._plus(other)

    def _times(self, other: Number) -> "Dual":
        if not isinstance(other, Dual):
            return self.mapped(self.value * other, lambda slope: _scaled(slope, other))
        slopes = tuple(
            _sum(_scaled(a, other.value), _scaled(b, self.value))
            for a, b in zip(self.slopes, other.slopes, strict=True)
        )
        return Dual(self.value * other.value, slopes)

    __mul__ = __rmul__ = _times

    def __truediv__(self, other: Number) -> "Dual":
        if not isinstance(other, Dual):
            return self._times(1.0 / other)
        share = 1.0 / other.value  # once: a division costs as much as ten products
        quotient = self.value * share
        along = -quotient * share
        return Dual(
            quotient,
            tuple(
                _sum(_scaled(a, share), _scaled(b, along))
                for a, b in zip(self.slopes, other.slopes, strict=True)
            ),
        )

    def __rtruediv__(self, other: Number) -> "Dual":
        share = 1.0 / self.value
        along = -other * share * share
        return self.mapped(other * share, lambda slope: _scaled(slope, along))

    def __lt__(self, other: Number) -> Number:
        return self.value < value_of(other)

    def __le__(self, other: Number) -> Number:
        return self.value <= value_of(other)

    def __gt__(self, other: Number) -> Number:
        return self.value > value_of(other)

    def __ge__(self, other: Number) -> Number:
        return self.value >= value_of(other)


def value_of(number: Number) -> Number:
    """Return the value of a dual number, or the number itself."""
    return number.value if isinstance(number, Dual) else number


def constant(value: Number, directions: int) -> Dual:
    """Return a dual number that does not vary."""
    return Dual(value, (0.0,) * directions)


def constants(values: tuple[Number, ...], directions: int) -> tuple[Dual, ...]:
    """Return dual numbers that do not vary."""
    return tuple(constant(value, directions) for value in values)


def variables(*values: Number) -> tuple[Dual, ...]:
    """Return dual numbers, each with slope 1 along a direction of its own."""
    return tuple(
        Dual(value, tuple(1.0 if i == j else 0.0 for j in range(len(values))))
        for i, value in enumerate(values)
    )


@dataclass(frozen=True)
class DualMathematics:
    """Dual numbers over another kind of number."""

    m: Mathematics

    @property
    def newton_steps(self) -> int:
        """Newton steps that an inverse may take."""
        return self.m.newton_steps

    @property
    def settled(self) -> float:
        """Length of Newton's last step from which on an inverse counts as found."""
        return self.m.settled

    def sqrt(self, a: Dual) -> Dual:
        """Return the square root."""
        root = self.m.sqrt(a.value)
        along = 0.5 / root
        return a.mapped(root, lambda slope: _scaled(slope, along))

    def sin(self, a: Dual) -> Dual:
        """Return the sine of an angle in radians."""
        slope_here = self.m.cos(a.value)
        return a.mapped(self.m.sin(a.value), lambda slope: _scaled(slope, slope_here))

    def cos(self, a: Dual) -> Dual:
        """Return the cosine of an angle in radians."""
        slope_here = -self.m.sin(a.value)
        return a.mapped(self.m.cos(a.value), lambda slope: _scaled(slope, slope_here))

    def atan2(self, y: Dual, x: Dual) -> Dual:
        """Return the angle of (x, y), radians."""
        share = 1.0 / (x.value * x.value + y.value * y.value)
        along_y, along_x = x.value * share, -y.value * share
        slopes = tuple(
            _sum(_scaled(dy, along_y), _scaled(dx, along_x))
            for dy, dx in zip(y.slopes, x.slopes, strict=True)
        )
        return Dual(self.m.atan2(y.value, x.value), slopes)

    def where(self, condition: Number, a: Number, b: Number) -> Number:
        """Return `a` where the condition holds, else `b`; slopes are chosen alike."""
        if not isinstance(a, Dual) and not isinstance(b, Dual):
            return self.m.where(condition, a, b)
        directions = len(a.slopes if isinstance(a, Dual) else b.slopes)
        a = a if isinstance(a, Dual) else constant(a, directions)
        b = b if isinstance(b, Dual) else constant(b, directions)
        slopes = tuple(
            0.0 if _is_zero(da) and _is_zero(db) else self.m.where(condition, da, db)
            for da, db in zip(a.slopes, b.slopes, strict=True)
        )
        return Dual(self.m.where(condition, a.value, b.value), slopes)

    def fma(self, a: Number, b: Number, c: Number) -> Number:
        """Return a b + c."""
        return a * b + c

    def polynomial(self, x: Dual, coefficients: tuple[Number, ...]) -> Dual:
        """Return c0 + c1 x + c2 x^2 + ..."""
        values = tuple(value_of(coefficient) for coefficient in coefficients)
        value = self.m.polynomial(x.value, values)
        steep = tuple(float(power) * c for power, c in enumerate(values[1:], start=1))
        along = self.m.polynomial(x.value, steep)
        slopes = tuple(_scaled(slope, along) for slope in x.slopes)
        power: Number = 1.0
        for coefficient in coefficients:
            if isinstance(coefficient, Dual):
                here = power
                own = tuple(_scaled(slope, here) for slope in coefficient.slopes)
                slopes = tuple(_sum(a, b) for a, b in zip(slopes, own, strict=True))
            power = power * x.value
        return Dual(value, slopes)

    def all_below(self, a: Number, limit: float) -> bool:
        """Return whether it is known that no element exceeds the limit."""
        return self.m.all_below(value_of(a), limit)
