"""Errors of a method on training points held out, each predicted by a fit to the others."""

from collections.abc import Callable

import numpy as np
from jaxtyping import Float64

from labcal.errors import InputError
from labcal.rng import generator

FOLDS = 5
"""Parts of the training data, each of which is held out once."""
Predict = Callable[[np.ndarray], np.ndarray]
"""From pixels (n, 2 x cameras) to points (n, outputs)."""


def held_out_errors(
    fitted: Callable[[np.ndarray, np.ndarray], Predict],
    pixels: Float64[np.ndarray, "n inputs"],
    points: Float64[np.ndarray, "n outputs"],
) -> Float64[np.ndarray, "n outputs"]:
    """Return predicted minus true points, mm, of points that the fit did not see.

    Parameters
    ----------
    fitted : callable
        From training pixels and points to the predictions of the method fitted to them.
    pixels, points : float64 array, (n, 2 x cameras) and (n, outputs)
        Px and mm. They are split into `FOLDS` parts at random, always in the same way.

    Returns
    -------
    float64 array, (n, outputs)
        NaN from the part on that leaves the method too few points, say.
    """
    errors = np.full_like(points, np.nan)
    part = generator(0, "user method", "folds").permutation(len(points)) % FOLDS
    for number in range(FOLDS):
        out = part == number
        if not out.any():
            continue
        try:
            errors[out] = fitted(pixels[~out], points[~out])(pixels[out])
        except InputError:
            break
        errors[out] -= points[out]
    return errors
