"""Roughness of a corner's fit above which something lies in its squares."""

import numpy as np

LEAST_ROUGHNESS = 1.0 / (255.0 * np.sqrt(12.0))
"""Root mean square of what rounding to 8 bits leaves, over the step from black to white.

Finer pictures without noise show where edges run between pixels instead, which differs from corner to corner
by more than noise does: to be several times as rough as others tells nothing there.
"""


def roughest_clear(usual: np.ndarray, factor: float) -> np.ndarray:
    """Return the most roughness of corners that nothing hides.

    Parameters
    ----------
    usual : ndarray
        That of the corners around, over the step.
    factor : float
        Over this.
    """
    return np.asarray(factor * np.maximum(usual, LEAST_ROUGHNESS))
