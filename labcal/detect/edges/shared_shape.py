"""Sums along outlines without what all dots share, and their powers, compiled."""

from math import sqrt

import numpy as np

from labcal.detect.compiled import compiled


@compiled
def without_shared(sums: np.ndarray, step: np.ndarray) -> np.ndarray:
    """Return sums (n, k, 2 or more) by harmonic, the first two, without what dots with steps (n) share.

    Two dots at least.
    """
    count, harmonics = sums.shape[0], sums.shape[1]
    kept, shared, squares = np.empty((count, harmonics, 2)), np.zeros((harmonics, 2)), 0.0
    for k in range(count):
        squares += step[k] * step[k]
        for j in range(harmonics):
            shared[j, 0] += step[k] * sums[k, j, 0]
            shared[j, 1] += step[k] * sums[k, j, 1]
    shared /= squares
    spread = sqrt(count / (count - 1.0))
    for k in range(count):
        for j in range(harmonics):
            for part in range(2):
                kept[k, j, part] = (sums[k, j, part] - step[k] * shared[j, part]) * spread
    return kept


@compiled
def with_powers(kept: np.ndarray, sums: np.ndarray) -> np.ndarray:
    """Return the power that is kept (n, k, 2) beside that of white noise, the last of the sums (n, k, 3)."""
    found = np.empty((kept.shape[0], kept.shape[1], 2))
    for k in range(kept.shape[0]):
        for j in range(kept.shape[1]):
            found[k, j, 0] = kept[k, j, 0] ** 2 + kept[k, j, 1] ** 2
            found[k, j, 1] = sums[k, j, 2]
    return found
