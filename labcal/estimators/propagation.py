"""Propagation of pixel covariances through the predictions of a method."""

from collections.abc import Callable

import numpy as np
from jaxtyping import Float64

STEP = 0.01
"""Of the differences, px: predictions bend little within it, and rounding is far below what it moves."""

Predict = Callable[[Float64[np.ndarray, "n inputs"]], Float64[np.ndarray, "n outputs"]]


def propagated_covariance(
    predict: Predict,
    pixels: Float64[np.ndarray, "n inputs"],
    pixel_covariance: Float64[np.ndarray, "n cameras 2 2"],
) -> Float64[np.ndarray, "n outputs outputs"]:
    """Return the covariances of predictions that the covariances of their pixels cause.

    The law of propagation of uncertainty (JCGM 102:2011, 6.2.1) with derivatives by central differences; the
    noise of different cameras is independent.

    Parameters
    ----------
    predict : callable
        From pixels (n, 2 x cameras) to predictions (n, outputs); each line depends on its own pixels only.
    pixels : float64 array, (n, 2 x cameras)
        Columns x1 y1 x2 y2 ..., px.
    pixel_covariance : float64 array, (n, cameras, 2, 2)
        Px squared; where one is NaN, so is what it causes.

    Returns
    -------
    float64 array, (n, outputs, outputs)
        In the units of the predictions, squared.
    """
    return propagated_covariances(predict, pixels, pixel_covariance)[0]


def propagated_covariances(
    predict: Predict,
    pixels: Float64[np.ndarray, "n inputs"],
    *pixel_covariances: Float64[np.ndarray, "n cameras 2 2"],
) -> list[Float64[np.ndarray, "n outputs outputs"]]:
    """Return what `propagated_covariance` does for each of several covariances, with derivatives made once.

    Parameters
    ----------
    predict, pixels
        As for `propagated_covariance`.
    *pixel_covariances : float64 array, (n, cameras, 2, 2)
        Px squared.
    """
    slopes = []
    for column in range(pixels.shape[1]):
        shift = np.zeros(pixels.shape[1])
        shift[column] = STEP
        slopes.append((predict(pixels + shift) - predict(pixels - shift)) / (2.0 * STEP))
    jacobian = np.stack(slopes, axis=-1).reshape(len(pixels), -1, pixels.shape[1] // 2, 2)
    found = []
    for covariance in pixel_covariances:
        propagated = np.einsum("nics,ncst,njct->nij", jacobian, covariance, jacobian, optimize=True)
        found.append(np.asarray(0.5 * (propagated + propagated.mT)))
    return found
