"""Arcs of a ring that something hides: the most likely ones, by dynamic programming around the circle."""

import numpy as np
from jaxtyping import Float64

from labcal.arrays import Mask


def most_likely_arcs(
    seen: Float64[np.ndarray, "words angles"], hidden: Float64[np.ndarray, "words angles"], switch: float
) -> tuple[Float64[np.ndarray, " words"], Mask]:
    """Return the greatest log-likelihood over all ways in which arcs of a ring may be hidden.

    Every angle is either in sight or hidden, and each change from one to the other around the circle costs
    the same, as in a hidden Markov model of two states; the best way is found by Viterbi's algorithm (Forney
    1973, The Viterbi algorithm, Proc. IEEE 61:268), once for each state of the first angle, so that the
    circle is closed.

    Parameters
    ----------
    seen, hidden : ndarray, shape (words, angles)
        Log-likelihood of what is seen at an angle, if the ring is in sight there and if it is hidden.
    switch : float
        Cost of an end of an arc.

    Returns
    -------
    ndarray, shape (words,)
        Log-likelihood of each word.
    ndarray of bool, shape (angles,)
        Where the ring is hidden, by the most likely word.
    """
    words, angles = seen.shape
    each = np.ascontiguousarray(np.stack([seen, hidden]).transpose(2, 0, 1))  # angle, state, word
    best = np.full((2, 2, words), -np.inf)  # state of the first angle, of the present one
    best[0, 0], best[1, 1] = each[0]
    came_over = np.zeros((angles, 2, 2, words), dtype=bool)
    for angle in range(1, angles):
        other = best[:, ::-1] - switch
        came_over[angle] = other > best
        best = np.maximum(best, other) + each[angle]
    best[[0, 1], [1, 0]] -= switch
    total = best.reshape(4, words).max(axis=0)
    word = int(np.argmax(total))
    first, state = divmod(int(np.argmax(best[:, :, word])), 2)
    arcs = np.zeros(angles, dtype=bool)
    for angle in range(angles - 1, -1, -1):
        arcs[angle] = state == 1
        state ^= int(came_over[angle, first, state, word])
    return total, arcs
