"""The curve from light to grey values that the print of a board shows, in compiled code.

Grey values of most cameras are a power of the light, of 1/2.2 and the like, from paper down to ink that is
not quite black. A blurred print X, between -1 (black) and 1, becomes a pattern with the same ends

    T(X) = (sqrt(1 + X sin 2t) - cos t) / sin t,    c = tan(t / 2) = T(0).

To first order it adds ``c (1 - X^2)``, as ink that has spread does. Fitted to sRGB and powers of 1/1.5 to
1/2.2, with ink of 2 to 20% of the paper, it leaves at most 0.01 of the half step, where ``c (1 - X^2)`` alone
leaves 0.009 to 0.07. A c of tan(pi / 8), 0.414, is that of a root with ink without light.
"""

from math import atan, cos, sin, sqrt

import numpy as np

from labcal.detect.compiled import compiled
from labcal.detect.corners.corner_chunks import BOARD, BY_A, BY_B, BY_CORRELATION, CHUNK

MOST_TONE = 0.4
"""Most that c is to either side."""
_SLIGHT = 1e-3


@compiled
def tone_terms(tone: float) -> tuple[float, float, float]:
    """Return sin 2t, cos t and sin t of a curve c; of a slight one 0, c and 1, which are its first order."""
    if abs(tone) < _SLIGHT:
        return 0.0, tone, 1.0
    t = 2.0 * atan(min(max(tone, -MOST_TONE), MOST_TONE))
    return sin(2.0 * t), cos(t), sin(t)


@compiled
def toned(X: float, terms: tuple[float, float, float]) -> tuple[float, float]:
    """Return T(X) and its slope, from the terms of :func:`tone_terms`."""
    a, m, h = terms
    if a == 0.0:
        return X + m * (1.0 - X * X), 1.0 - 2.0 * m * X
    root = sqrt(max(1.0 + a * X, 0.0))
    return (root - m) / h, 0.5 * a / (max(root, _SLIGHT) * h)


@compiled
def untoned(T: float, terms: tuple[float, float, float]) -> float:
    """Return the X that is shown as T."""
    a, m, h = terms
    if a == 0.0:
        return T - m * (1.0 - T * T)
    root = T * h + m
    return (root * root - 1.0) / a


@compiled
def tone_chunk(space: np.ndarray, tone: float) -> None:
    """Show the pattern of a chunk, and its derivatives, in the workspace by a curve."""
    terms = tone_terms(tone)
    for k in range(CHUNK):
        shown, slope = toned(space[BOARD + k], terms)
        space[BOARD + k] = shown
        space[BY_A + k] *= slope
        space[BY_B + k] *= slope
        space[BY_CORRELATION + k] *= slope


@compiled
def by_tone(X: np.ndarray, tone: float) -> np.ndarray:
    """Return the derivative of T by c at patterns, shape (n,)."""
    a, m, h = tone_terms(tone)
    if a == 0.0:
        return np.asarray(1.0 - X * X)
    found = np.empty(len(X))
    for k in range(len(X)):
        root = max(sqrt(max(1.0 + a * X[k], 0.0)), _SLIGHT)
        found[k] = 1.0 + ((m * m - h * h) * X[k] / root - (root - m) * m / h) / h
    return np.asarray(found * (2.0 / (1.0 + tone * tone)))
