"""Scale of what a method states of its own errors, by errors on points with a known place."""

from collections.abc import Callable

import numpy as np
from jaxtyping import Float64

from labcal.distributions import chi2_quantile
from labcal.geometry.covariances import positive_definite

LEAST, MOST = 0.1, 1e12
"""Bounds of a scale. Below, errors are those of the pixels' noise, and tell nothing of the method's own."""
_BELIEVED = float(np.log(2.0))
"""Standard deviation of the logarithm of a scale before errors are known: a variance is right to a factor of
two."""
_FEWEST = 100
"""Errors from which on coverage is known to 2%."""
_BISECTIONS, _STEPS = 50, 64


def own_scale(
    error: Float64[np.ndarray, "n dim"],
    noise: Float64[np.ndarray, "n dim dim"],
    own: Float64[np.ndarray, "n dim dim"],
    confidence: float,
) -> float:
    """Return the factor of a method's own covariance with which ellipsoids hold their share of errors.

    The most probable factor, by the number of errors within the ellipsoids (normal, with the variance of a
    proportion) and a prior about 1 that matters only where the pixels' noise hides what the method adds.
    This is split conformal prediction (Lei et al. 2018, section 5.2) with two differences: the ellipsoids
    stay as they are stated, and of the covariance only that is scaled which is not known.

    Parameters
    ----------
    error : float64 array, (n, d)
        Predicted minus true, of points that the method was not trained on.
    noise, own : float64 array, (n, d, d)
        Covariances by the pixels' noise, and by the method itself.
    confidence : float
        The share.

    Returns
    -------
    float
        Of `own`; 1 where there are too few errors to tell.
    """
    total = noise + own
    known = positive_definite(total) & np.isfinite(error).all(axis=1)
    if known.sum() < _FEWEST:
        return 1.0
    root = np.linalg.cholesky(total[known])
    half = np.linalg.solve(root, own[known])
    share, axes = np.linalg.eigh(np.linalg.solve(root, half.mT))
    white = np.linalg.solve(root, error[known, :, None])
    square = ((axes.mT @ white)[:, :, 0]) ** 2
    limit = chi2_quantile(confidence, error.shape[1])

    def covered(log_scale: float) -> float:
        """Return the share of errors within the ellipsoids."""
        variance = np.maximum(1.0 + np.expm1(log_scale) * share, np.finfo(np.float64).tiny)
        return float(((square / variance).sum(axis=1) <= limit).mean())

    return float(np.exp(_most_probable(covered, confidence, int(known.sum()))))


def _most_probable(covered: Callable[[float], float], confidence: float, n: int) -> float:
    """Return the logarithm of the scale; it lies between 0 and where the share is that of the confidence."""
    near, far = 0.0, float(np.log(LEAST if covered(0.0) > confidence else MOST))
    too_many = far < 0.0
    for _ in range(_BISECTIONS):
        middle = 0.5 * (near + far)
        near, far = (middle, far) if (covered(middle) > confidence) == too_many else (near, middle)
    tried = np.linspace(0.0, far, _STEPS)
    off = np.array([covered(log_scale) for log_scale in tried]) - confidence
    cost = off**2 * n / (confidence * (1.0 - confidence)) + (tried / _BELIEVED) ** 2
    return float(tried[int(np.argmin(cost))])
