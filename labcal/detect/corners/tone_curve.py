"""The curve from light to grey values that the print of a board shows, in compiled code.

Grey values of most cameras are a power of the light, of 1/2.2 and the like, from paper down to ink that is
not quite black. A blurred print X, between -1 (black) and 1, becomes a pattern with the same ends

    T(X) = (sqrt(1 + a X) - m) / h,    a = tanh(4 c),

with m and h from T(-1) = -1 and T(1) = 1. To first order it adds ``c (1 - X^2)``, as ink that has spread
does. Fitted to sRGB and powers of 1/1.5 to 1/2.2, with ink of 2 to 20% of the paper, it leaves at most 0.01
of the half step, where ``c (1 - X^2)`` alone leaves 0.009 to 0.07.
"""

from math import sqrt, tanh

import numpy as np

from labcal.detect.compiled import compiled

_SLIGHT = 1e-3
_STEEP = 4.0


@compiled
def tone_terms(tone: float) -> tuple[float, float, float]:
    """Return a, m and h of a curve c; a is 0 for a slight one, which is taken to first order."""
    if abs(tone) < _SLIGHT:
        return 0.0, tone, 1.0
    a = tanh(_STEEP * tone)
    upper, lower = sqrt(1.0 + a), sqrt(1.0 - a)
    return a, 0.5 * (upper + lower), 0.5 * (upper - lower)


@compiled
def toned(X: float, terms: tuple[float, float, float]) -> tuple[float, float]:
    """Return T(X) and its slope, from the terms of :func:`tone_terms`."""
    a, m, h = terms
    if a == 0.0:
        return X + m * (1.0 - X * X), 1.0 - 2.0 * m * X
    root = sqrt(max(1.0 + a * X, 0.0))
    return (root - m) / h, 0.5 * a / (max(root, _SLIGHT) * h)


@compiled
def by_tone(X: np.ndarray, tone: float) -> np.ndarray:
    """Return the derivative of T by c at patterns, shape (n,)."""
    a, m, h = tone_terms(tone)
    if a == 0.0:
        return np.asarray(1.0 - X * X)
    upper, lower = sqrt(1.0 + a), sqrt(1.0 - a)
    of_m, of_h = 0.25 / upper - 0.25 / lower, 0.25 / upper + 0.25 / lower
    found = np.empty(len(X))
    for k in range(len(X)):
        root = max(sqrt(max(1.0 + a * X[k], 0.0)), _SLIGHT)
        found[k] = (0.5 * X[k] / root - of_m - (root - m) / h * of_h) / h
    return np.asarray(found * (_STEEP * (1.0 - a * a)))
