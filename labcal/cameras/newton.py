"""Newton's method for two unknowns, whose derivatives come from dual numbers."""

from collections.abc import Callable
from dataclasses import dataclass

from labcal.cameras.dual import Dual, DualMathematics, constant, constants, value_of, variables
from labcal.cameras.mathematics import Mathematics, Number

_FLAT = 1e-6
"""Determinant below which a step would leave the part of the function that has an inverse."""
_EXACT = 1e-30
"""Squared step from which on float64 gains nothing more."""

Residuals = Callable[[Dual, Dual], tuple[Dual, Dual]]


@dataclass(frozen=True)
class Solution:
    """The two unknowns, and the state of the iteration."""

    a: Number
    b: Number
    ok: Number
    """True if Newton's last step was short enough, which means that the solution is found."""
    determinant: Number
    """Of the derivatives, before the last step."""


def solve_two(m: Mathematics, residuals: Residuals, a: Number, b: Number) -> Solution:
    """Find where two residuals vanish, starting at (a, b).

    Parameters
    ----------
    m : Mathematics
        Gives the number of steps; NumPy stops early once every element is exact.
    residuals : callable
        Takes the unknowns as dual numbers with the directions a and b, returns both residuals.
    a, b : number
        Start.

    Returns
    -------
    Solution
        Not ok where Newton did not converge, and for NaN.
    """
    length2 = determinant = 0.0 * a + 1.0
    for _ in range(m.newton_steps):
        f, g = residuals(*variables(a, b))
        (fa, fb), (ga, gb) = f.slopes, g.slopes
        determinant = fa * gb - fb * ga
        share = 1.0 / m.where(determinant * determinant > _FLAT * _FLAT, determinant, 1.0)
        step_a = (gb * f.value - fb * g.value) * share
        step_b = (fa * g.value - ga * f.value) * share
        a, b = a - step_a, b - step_b
        length2 = step_a * step_a + step_b * step_b
        if m.all_below(length2, _EXACT):
            break
    scale2 = 1.0 + a * a + b * b
    return Solution(a, b, length2 < m.settled * m.settled * scale2, determinant)


@dataclass(frozen=True)
class Root:
    """One unknown, and the state of the iteration."""

    t: Number
    ok: Number
    """True if Newton's last step was short enough, which means that the solution is found."""
    slope: Number
    """Of the residual, before the last step."""


def solve_one(m: Mathematics, residual: Callable[[Dual], Dual], t: Number) -> Root:
    """Find where a growing residual vanishes, starting at t.

    Parameters
    ----------
    m : Mathematics
        Gives the number of steps; NumPy stops early once every element is exact.
    residual : callable
        Takes the unknown as a dual number with one direction.
    t : number
        Start.

    Returns
    -------
    Root
        Not ok where Newton did not converge, where the residual does not grow, and for NaN.
    """
    step = slope = 0.0 * t + 1.0
    for _ in range(m.newton_steps):
        f = residual(*variables(t))
        (slope,) = f.slopes
        step = f.value / m.where(slope > _FLAT, slope, 1.0)
        t = t - step
        if m.all_below(step * step, _EXACT):
            break
    return Root(t, (step * step < m.settled * m.settled * (1.0 + t * t)) & (slope > _FLAT), slope)


ParametricResiduals = Callable[[DualMathematics, Dual, Dual, tuple[Dual, ...]], tuple[Dual, Dual]]


def solve_two_for(
    m: Mathematics, residuals: ParametricResiduals, parameters: tuple[Number, ...], a: Number, b: Number
) -> Solution:
    """Find where two residuals vanish, with the solution's slopes where the parameters have slopes.

    Parameters
    ----------
    m : Mathematics
        For dual parameters a :class:`DualMathematics`.
    residuals : callable
        Takes mathematics, unknowns and parameters, all dual; returns both residuals.
    parameters : tuple of number
    a, b : number
        Start, without slopes.

    Notes
    -----
    The slopes are those of one more Newton step whose residuals carry the parameters' slopes, which is the
    implicit function theorem.
    """
    plain = m.m if isinstance(m, DualMathematics) else m
    lifted = constants(tuple(value_of(parameter) for parameter in parameters), 2)
    found = solve_two(plain, lambda a, b: residuals(DualMathematics(plain), a, b, lifted), a, b)
    if not isinstance(m, DualMathematics):
        return found
    directions = len(parameters[0].slopes)
    unknowns = variables(found.a, found.b)
    f, g = residuals(DualMathematics(plain), unknowns[0], unknowns[1], lifted)
    (fa, fb), (ga, gb) = f.slopes, g.slopes
    f, g = residuals(m, constant(found.a, directions), constant(found.b, directions), parameters)
    determinant = fa * gb - fb * ga
    a, b = (fb * g - gb * f) / determinant, (ga * f - fa * g) / determinant
    return Solution(found.a + a, found.b + b, found.ok, determinant)
