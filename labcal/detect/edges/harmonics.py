"""Residuals of converged fits along the outline, in harmonics that a fit leaves free, compiled."""

from math import sqrt
from typing import NamedTuple

import numpy as np
from jaxtyping import Int

from labcal.detect.cholesky import solve
from labcal.detect.compiled import compiled
from labcal.detect.edges.certainty import factor_of, held_by_priors
from labcal.detect.edges.edge_model import CHUNK, PARAMETERS, PLANES, TINY
from labcal.detect.edges.weighed_pixels import LINES, weighed_sums
from labcal.detect.row_products import HIGH, WIDE

FOLLOWED = 3
"""The highest harmonic that a fit can follow: its parameters have no higher ones."""


class Harmonics(NamedTuple):
    """The harmonics ``first, first + stride, ...`` of the angle along the outline, so many terms."""

    first: int
    stride: int
    terms: int

    @property
    def numbers(self) -> Int[np.ndarray, " k"]:
        """Numbers of waves around the outline."""
        return self.first + self.stride * np.arange(self.terms)


class KeptFits(NamedTuple):
    """Parts of converged fits from which the residuals along their outlines follow.

    Attributes
    ----------
    weights : ndarray, shape (n, 2, PARAMETERS)
        Weights of the fit's parameters in the centre that is stated.
    certainty : ndarray, shape (n, CERTAINTY)
        Factorised systems, see :mod:`~labcal.detect.edges.certainty`.
    pixels : ndarray of float32, shape (3, m)
        x, y and value of the pixels of all dots, those of a dot's edge before its flat ones.
    places : ndarray of int, shape (n, 3)
        A dot's first pixel, the number of its edge's pixels, and that of all.
    """

    weights: np.ndarray
    certainty: np.ndarray
    pixels: np.ndarray
    places: np.ndarray

    def select(self, which: np.ndarray) -> "KeptFits":
        """Return some of the fits, by mask or by index."""
        return KeptFits(self.weights[which], self.certainty[which], self.pixels, self.places[which])


@compiled
def harmonic_sums(table: np.ndarray, fits: KeptFits, numbers: np.ndarray) -> np.ndarray:
    """Return sums of each dot's residuals by harmonic, and the power that white noise would have, (n, k, 3).

    The centre that is stated is a weighted sum of a dot's pixels. For a round dot the weight is a profile
    across the edge times the cosine of the angle. The residuals are summed with the same profile times the
    cosine and the sine of multiples of the angle. The last column is the expected sum of the squares of
    both for noise of variance 1. All is for weights whose squares add up to 1.

    A fit takes from a test function `t` what it can follow: of white noise
    ``t't - t'G inv(A) G't - |P inv(A) G't|^2`` is left, for derivatives G, priors P and A = G'G + P'P. Of
    harmonics above the third, which a fit has no parameters for, that is below 0.003 and counts as nothing.

    Parameters
    ----------
    table : ndarray, shape (n, COLUMNS)
        Converged fits, see :func:`~labcal.detect.edges.gauss_newton.fit_all`.
    fits : KeptFits
        Of the same fits.
    numbers : ndarray of int, shape (k,)
        Of the harmonics, increasing, from 1 on.

    Returns
    -------
    ndarray, shape (n, k, 3)
    """
    sums = np.zeros((len(table), len(numbers), 3))
    products = np.empty((HIGH, WIDE * -(-(1 + 2 * len(numbers)) // WIDE)))
    followed = np.empty((PARAMETERS + HIGH if numbers[0] <= FOLLOWED else 0, WIDE))
    results = products, followed
    work = np.zeros(PLANES * CHUNK), np.zeros((LINES + products.shape[1]) * CHUNK)
    for number in range(len(table)):
        row, certainty = table[number], fits.certainty[number]
        factor, wanted = factor_of(certainty), fits.weights[number].copy()
        for axis in range(2):
            solve(factor, wanted[axis])
        weighed_sums(row, (fits.pixels, fits.places[number]), wanted, numbers, results, work)
        own = products[0, 0]  # the sum of the squares of both test functions of any harmonic
        scale = 1.0 / sqrt(max(own, TINY))
        for harmonic in range(len(numbers)):
            for part in range(2):
                sums[number, harmonic, part] = products[1, 1 + 2 * harmonic + part] * scale
            sums[number, harmonic, 2] = min(own / TINY, 1.0)
        if len(followed) > 0:
            lost = _followed_power(followed, factor, certainty) / max(own, TINY)
            sums[number, 0, 2] = max(sums[number, 0, 2] - lost, 0.0)
    return sums


@compiled
def _followed_power(followed: np.ndarray, factor: np.ndarray, certainty: np.ndarray) -> float:
    """Return what a fit takes from white noise in two test functions, the first two columns, (16, 4).

    Rows are the products of the derivatives by the parameters with the test functions.
    """
    lost = 0.0
    for test in range(2):
        step = followed[:PARAMETERS, test].copy()
        solve(factor, step)
        for i in range(PARAMETERS):
            lost += followed[i, test] * step[i]
        lost += held_by_priors(certainty, step)
    return lost
