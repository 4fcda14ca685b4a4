"""Noise of outlines that differs by direction: what JPEG and demosaicing leave is often stronger in rows."""

import numpy as np
from jaxtyping import Float64

from labcal.detect.edges.harmonics import Harmonics
from labcal.detect.medians import median_of
from labcal.detect.stage_settings.edge import EdgeSettings

_NEIGHBOURS = 2
"""Difference of the numbers of two harmonics whose products tell the direction."""
_USUAL = 0.2
"""Usual difference, against which an uncertain one is weighed: a fifth more than the mean in x, less in y."""
_MOST = 0.8
"""Largest difference, with which variances stay positive."""
_ALIKE = np.eye(2)


def neighbouring(harmonics: Harmonics) -> Harmonics:
    """Return as many harmonics with neighbouring odd numbers, from the same longest wave on.

    The chosen ones of a large dot are further apart, and tell no direction.
    """
    return harmonics._replace(stride=_NEIGHBOURS)


def noise_by_direction(
    sums: Float64[np.ndarray, "n k 2"],
    expected: Float64[np.ndarray, "n k"],
    harmonics: Harmonics,
    settings: EdgeSettings,
) -> Float64[np.ndarray, "2 2"]:
    """Return the covariance of a shift by noise along outlines, in units of the mean of both axes.

    Parameters
    ----------
    sums : ndarray, shape (n, k, 2)
        Residuals times cosine and sine of each harmonic, without what all dots share, by dot.
    expected : ndarray, shape (n, k)
        Sum of both squares that white noise would have.
    harmonics : Harmonics
    settings : EdgeSettings

    Returns
    -------
    ndarray, shape (2, 2)
        Its trace is 2; the identity where the harmonics do not tell.

    Notes
    -----
    Let noise at the angle phi of the outline have the variance ``1 + a cos 2 phi + b sin 2 phi``. Harmonics
    with neighbouring odd numbers are then correlated: with C and S the sums by cosine and sine of j, C' and
    S' of j + 2, the expected value of ``C C' + S S'`` is a / 2 times that of ``C^2 + S^2``, and that of
    ``C S' - S C'`` is b / 2 times. A shift is the first harmonic; its covariance is
    ``[[1 + a / 2, b / 2], [b / 2, 1 - a / 2]]`` in units of the mean. Both are shrunk by their uncertainty.
    """
    if harmonics.stride != _NEIGHBOURS or harmonics.terms == 1:
        return _ALIKE
    seen, white = (sums**2).sum(axis=(1, 2)), expected.sum(axis=1)
    seen, sums = seen[white > 0.0] / white[white > 0.0], sums[white > 0.0]
    if len(seen) == 0 or not (seen > 0.0).any():
        return _ALIKE
    sums = sums[seen <= settings.noise_outlier_factor * median_of(seen)]
    power = (sums**2).sum(axis=(0, 2))
    scale = np.sqrt(power[:-1] * power[1:])
    if not (scale > 0.0).all():
        return _ALIKE
    (c, s), (c_next, s_next) = np.moveaxis(sums[:, :-1], 2, 0), np.moveaxis(sums[:, 1:], 2, 0)
    along = np.mean((c * c_next + s * s_next).sum(axis=0) / scale)
    across = np.mean((c * s_next - s * c_next).sum(axis=0) / scale)
    variance = 1.0 / (2.0 * len(sums) * len(scale))  # of either, where noise is alike in all directions
    found = np.array([along, across]) / (1.0 + variance / _USUAL**2)
    found *= min(1.0, _MOST / max(float(np.hypot(*found)), _MOST))
    return np.array([[1.0 + found[0], found[1]], [found[1], 1.0 - found[0]]])
