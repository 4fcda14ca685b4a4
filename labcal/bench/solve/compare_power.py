"""The chance with which a comparison of two calibrations finds a change of a known size."""

import numpy as np
from scipy.optimize import brentq

from labcal.evaluate.comparison.weighted_squares import weighted_squares_tail
from labcal.evaluate.comparison.without_motion import RemainingDifference

_DRAWS = 20_000
_DETERMINED = 1e-12
"""Share of the largest weight below which a direction of errors counts for nothing."""


def power(
    before: RemainingDifference, changed: RemainingDifference, chance: float, random: np.random.Generator
) -> float:
    """Return the chance of a p-value below `chance` after a change, over the errors of both calibrations.

    Parameters
    ----------
    before, changed : RemainingDifference
        Of the same calibrations, before and after a change of one of them: they differ by its effect.
    chance : float
        Below which calibrations count as inconsistent.
    random : numpy.random.Generator

    Notes
    -----
    The statistic of the test is ``T = (R z + d)' W (R z + d)``: z are standard normal deviates, R the root of
    the covariance of differences, d the effect of the change. In the axes of ``R'WR`` with eigenvalues l it
    is ``sum l_i (z_i + a_i)^2 + rest``, a noncentral weighted sum of squares, whose distribution is drawn
    from. Its threshold is that of the central sum.
    """
    if changed.one is None or changed.other is None:
        return float("nan")
    W = changed.weight[changed.tested]
    d = (changed.difference - before.difference)[changed.tested]
    root = np.concatenate([changed.one.root[changed.tested], changed.other.root[changed.tested]], axis=2)
    weighed = (W @ root).reshape(-1, root.shape[2])
    weights, axes = np.linalg.eigh(root.reshape(weighed.shape).T @ weighed)
    kept = weights > _DETERMINED * weights[-1]
    weights, along = weights[kept], (d.ravel() @ weighed) @ axes[:, kept]
    shift = along / weights
    rest = max(0.0, float(np.einsum("ni,nij,nj->", d, W, d)) - float(weights @ shift**2))
    mean = float(weights.sum())
    threshold = brentq(lambda value: weighted_squares_tail(value, weights) - chance, mean, 1e3 * mean)
    drawn = (random.standard_normal((_DRAWS, len(weights))) + shift) ** 2 @ weights + rest
    return float((drawn > threshold).mean())
