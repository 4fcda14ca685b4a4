"""A first guess of the inverse of a radial mapping: a polynomial, so that Newton needs a step or two."""

from collections.abc import Callable, Sequence
from itertools import zip_longest

import numpy as np

from labcal.cameras.dual import Dual, DualMathematics
from labcal.cameras.mathematics import Mathematics, Number
from labcal.cameras.newton import Root, solve_one

DEGREE = 8
LENGTH = DEGREE + 2
"""Number of parameters of a guess."""
_SAMPLES = 129
_VANISHING = 1e-60
_SHORT_OF_FOLD = 0.999
"""A guess is fitted this far towards the fold, where the inverse has no slope."""


def inverse_guess(
    forward: Callable[[np.ndarray], np.ndarray], fold: float, reach: float
) -> tuple[float, ...]:
    """Fit the inverse of a radial mapping with a slope of about one at its middle.

    Parameters
    ----------
    forward : callable
        Takes field radii from 0 on (an array), returns image radii, growing up to the fold.
    fold : float
        Field radius where it stops growing; infinity where it never does.
    reach : float
        Largest image radius wanted.

    Returns
    -------
    tuple of float
        1 / reach^2, then the coefficients of field radius over image radius in (image radius / reach)^2.
    """
    farthest = _field_radius(forward, fold, reach)
    # Chebyshev nodes keep the fit as good at the rim as in the middle.
    field = farthest * np.cos(0.5 * np.pi * (np.arange(_SAMPLES) + 0.5) / _SAMPLES)
    image = np.asarray(forward(field))
    reach = float(forward(np.array([farthest]))[0])
    fit = np.polynomial.Chebyshev.fit((image / reach) ** 2, field / image, DEGREE, domain=[0.0, 1.0])
    return (1.0 / reach**2, *_powers(fit.coef))


def guess(m: Mathematics, parameters: tuple[Number, ...], r2: Number) -> Number:
    """Return field radius over image radius, from the squared image radius; constant beyond the fit."""
    s = r2 * parameters[0]
    return m.polynomial(m.where(s < 1.0, s, 1.0), parameters[1:LENGTH])


def field_over_image(
    m: Mathematics,
    stretch: Callable[[DualMathematics, Dual], Dual],
    guessed: tuple[Number, ...],
    r2: Number,
) -> Root:
    """Return field radius over image radius of a mapping that is the same all around, by Newton's method.

    Parameters
    ----------
    m : Mathematics
    stretch : callable
        Takes mathematics and the squared field radius, both dual; returns image radius over field radius.
    guessed : tuple of number
        Of :func:`inverse_guess`.
    r2 : number
        Squared image radius.
    """
    d = DualMathematics(m)
    return solve_one(m, lambda ratio: ratio * stretch(d, ratio * ratio * r2) - 1.0, guess(m, guessed, r2))


def _powers(chebyshev: np.ndarray) -> tuple[float, ...]:
    """Return the coefficients of powers of s of a Chebyshev series in 2 s - 1, by Clenshaw's rule.

    NumPy's own conversion gives the same bytes, in ten times the time: it copies and checks every polynomial.
    """
    series = chebyshev.tolist()
    last, before = [series[-1]], [series[-2]]
    for c in series[-3::-1]:
        last, before = _sum(before, _times_twice(last)), _sum([c], [-value for value in last])
    return tuple(_sum(before, [0.5 * value for value in _times_twice(last)]))


def _times_twice(polynomial: list[float]) -> list[float]:
    """Return a polynomial times 2 (2 s - 1)."""
    return _sum([-2.0 * value for value in polynomial], [0.0, *(4.0 * value for value in polynomial)])


def _sum(one: list[float], other: list[float]) -> list[float]:
    return [a + b for a, b in zip_longest(one, other, fillvalue=0.0)]


def _field_radius(forward: Callable[[np.ndarray], np.ndarray], fold: float, reach: float) -> float:
    """Return the field radius that is imaged at `reach`, or one short of the fold, by bisection."""
    high = _SHORT_OF_FOLD * fold if np.isfinite(fold) else reach
    while not np.isfinite(fold) and forward(np.array([high]))[0] < reach:
        high *= 2.0
    if forward(np.array([high]))[0] <= reach:
        return high
    low = 0.0
    for _ in range(60):
        middle = 0.5 * (low + high)
        if not low < middle < high:  # no number lies between
            break
        low, high = (middle, high) if forward(np.array([middle]))[0] < reach else (low, middle)
    return high


def positive_roots(coefficients: Sequence[float] | np.ndarray) -> list[float]:
    """Return the positive real roots of a polynomial, whose coefficients begin with the constant's."""
    # The root that a next to vanishing coefficient adds lies beyond all that is imaged, and may be no number.
    kept = np.where(np.abs(coefficients) < _VANISHING, 0.0, coefficients)
    if not np.any(kept[1:]):
        return []
    roots = np.polynomial.polynomial.polyroots(np.trim_zeros(kept, "b"))
    return [float(root.real) for root in roots if abs(root.imag) <= 1e-12 * abs(root) and root.real > 0.0]
