"""By how much dots scatter more than their covariances say."""

import numpy as np
from jaxtyping import Float64
from scipy.optimize import brentq


def extra_variance(
    residual: Float64[np.ndarray, "n 2"], covariance: Float64[np.ndarray, "n 2 2"], share: float
) -> float:
    """Return the variance (px squared) to add so that residuals are as large as they should be.

    What a model does not know (a print that is off, a lens of another kind) makes residuals that do not
    shrink with a dot's own noise. Weights that ignore this trust the sharpest dots too much, and stated
    uncertainties are too small.

    Parameters
    ----------
    residual : ndarray, shape (n, 2)
        Pixels.
    covariance : ndarray, shape (n, 2, 2)
        Of the measured positions alone, px squared.
    share : float
        Degrees of freedom over the number of residuals' components.

    Returns
    -------
    float
        0 where the residuals are no larger than stated.

    Notes
    -----
    Solves sum r' (C + s I)^-1 r = expected for s, as in random-effects models (Paule and Mandel 1982).
    """
    spread, axes = np.linalg.eigh(covariance)
    square = np.einsum("nji,nj->ni", axes, residual) ** 2
    expected = share * square.size

    def excess(root: float) -> float:
        return float((square / (spread + root * root)).sum() - expected)

    if len(residual) == 0 or excess(0.0) <= 0.0:
        return 0.0
    top = 2.0 * float(np.sqrt(square.sum() / expected))
    root: float = brentq(excess, 0.0, top, xtol=1e-9 * top)
    return root**2
