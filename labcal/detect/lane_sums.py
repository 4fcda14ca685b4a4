"""Sums of many numbers, four at a time, in compiled code: one sum would wait for each of its additions."""

import numpy as np

from labcal.detect.compiled import compiled

_LANES = 4


@compiled
def total(values: np.ndarray) -> float:
    """Return the sum of numbers (n,)."""
    a = b = c = d = 0.0
    whole = len(values) - len(values) % _LANES
    for k in range(0, whole, _LANES):
        a, b, c, d = a + values[k], b + values[k + 1], c + values[k + 2], d + values[k + 3]
    for k in range(whole, len(values)):
        a += values[k]
    return (a + b) + (c + d)


@compiled
def total_of_products(left: np.ndarray, right: np.ndarray) -> float:
    """Return the scalar product of numbers (n,) and at least as many others."""
    a = b = c = d = 0.0
    whole = len(left) - len(left) % _LANES
    for k in range(0, whole, _LANES):
        a, b = a + left[k] * right[k], b + left[k + 1] * right[k + 1]
        c, d = c + left[k + 2] * right[k + 2], d + left[k + 3] * right[k + 3]
    for k in range(whole, len(left)):
        a += left[k] * right[k]
    return (a + b) + (c + d)


@compiled
def greatest(values: np.ndarray) -> float:
    """Return the greatest of at least one number (n,), none of them NaN."""
    a = b = c = d = values[0]
    whole = len(values) - len(values) % _LANES
    for k in range(0, whole, _LANES):
        a, b, c, d = max(a, values[k]), max(b, values[k + 1]), max(c, values[k + 2]), max(d, values[k + 3])
    for k in range(whole, len(values)):
        a = max(a, values[k])
    found: float = max(a, b, c, d)
    return found
