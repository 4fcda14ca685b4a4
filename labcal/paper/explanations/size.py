"""The size of a mistake that gives an error, solved for."""

import math
from collections.abc import Callable, Sequence

from scipy.optimize import brentq

PRECISION = 0.05
"""A size is solved for to this fraction of itself."""
_MOST_STEPS = 12


def size_giving(target: float, error_at: Callable[[float], float], sizes: Sequence[float]) -> float | None:
    """Return the smallest size at which an error reaches a target, or None if none of the sizes does.

    Sizes are tried in their order; between the last one below the target and the first one that is not, the
    size is found by bisection with interpolation (Brent 1973) in logarithms, to 5%. An error may fall with
    size elsewhere: what is returned lies in the first pair of sizes that brackets the target.

    Parameters
    ----------
    target : float
        Positive.
    error_at : callable
        The error of a size, not negative. NaN, where there is no error at this size, counts as not reached.
    sizes : sequence of float
        Positive, ascending.
    """

    def log_ratio(log_size: float) -> float:
        error = error_at(math.exp(log_size))
        return math.log(error / target) if error > 0 else -math.inf

    below: float | None = None
    for size in sizes:
        if error_at(size) >= target:
            if below is None:
                return size
            found = brentq(
                lambda log_size: max(log_ratio(log_size), _LEAST),
                math.log(below),
                math.log(size),
                xtol=PRECISION,
                maxiter=_MOST_STEPS,
                disp=False,
            )
            return math.exp(found)
        below = size
    return None


_LEAST = -50.0
"""Of a logarithm: errors of nothing are as good as this."""
