"""The picture of a straight edge behind a lens, in closed form."""

import numpy as np
from scipy.stats import norm


def mean_in_squares(distance: np.ndarray, sides: np.ndarray, sigma: float) -> np.ndarray:
    """Return the means over squares of a step that is blurred by a Gauss function.

    They are second differences of the step's second integral.

    Parameters
    ----------
    distance : ndarray
        Of the squares' middles from the edge, px.
    sides : ndarray, shape (2,)
        Sides of the squares times the normal of the edge.
    sigma : float
        0: none.
    """

    def twice(x: np.ndarray) -> np.ndarray:
        if sigma == 0.0:
            return 0.5 * np.maximum(x, 0.0) ** 2
        return 0.5 * ((x**2 + sigma**2) * norm.cdf(x / sigma) + x * sigma * norm.pdf(x / sigma))

    across, down = np.abs(sides)
    near, far = 0.5 * (across - down), 0.5 * (across + down)
    second = twice(distance + far) - twice(distance + near) - twice(distance - near) + twice(distance - far)
    return second / (across * down)
