"""Magnification of what is too small to be drawn as long as it is."""

import numpy as np


def round_magnification(most: float) -> float:
    """Return the largest of 1, 2, 5, 10 ..., or of 0.5, 0.2, 0.1 ..., that is not beyond `most`."""
    power = 10.0 ** np.floor(np.log10(most))
    return float(max(step * power for step in (1.0, 2.0, 5.0) if step * power <= most * (1 + 1e-9)))
