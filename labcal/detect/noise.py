"""How noise that is tied from pixel to pixel widens the covariances of a picture's dots."""

from dataclasses import dataclass

import cv2
import numpy as np

_WINDOW = 5  # px: over which the noise of neighbouring pixels is looked at together
_TELLING = 0.5  # a dot so small that its fit leaves less of the noise's scatter cannot tell it
_DOTS = 24  # looked at, evenly over the picture; more would cost time and tell little


@dataclass(frozen=True)
class Scatter:
    """The end of one dot's fit.

    Attributes
    ----------
    mask : ndarray of bool, shape (h, w)
        The pixels of the fit in their rectangle.
    basis : ndarray, shape (p, n)
        Derivatives of the grey values by what is fitted, the centre first.
    normal : ndarray, shape (p, p)
        ``basis basis'``, with priors.
    noise : ndarray, shape (n,)
        Residuals.
    variance : float
        Of one pixel.
    """

    mask: np.ndarray
    basis: np.ndarray
    normal: np.ndarray
    noise: np.ndarray
    variance: float


def noise_factor(scatters: list[Scatter]) -> float:
    """Return by how much the covariances of a picture's fits are too small, at least 1.

    Demosaicing and compression tie the noise of neighbouring pixels together, and noise may differ between the
    edge and its surroundings. The scatter of the fits' gradients over windows of some pixels, pooled over dots,
    shows both (a sandwich estimate; White 1980, Newey and West 1987).
    """
    pairs = [_observed_and_expected(scatter) for scatter in scatters[:: 1 + len(scatters) // _DOTS]]
    expected = sum(pair[1] for pair in pairs)
    return max(1.0, sum(pair[0] for pair in pairs) / expected) if expected > 0 else 1.0


def _observed_and_expected(scatter: Scatter) -> tuple[float, float]:
    """Return the gradient's scatter as seen and as independent noise would give it, in units of J'J.

    Residuals are orthogonal to what is fitted, so even independent noise scatters less than ``J' J`` says. Both
    are 0 for a dot too small to tell.
    """
    basis = scatter.basis
    inverse = np.linalg.inv(scatter.normal)
    score = np.zeros(scatter.mask.shape)
    products = np.zeros((*scatter.mask.shape, len(basis)))
    observed = expected = 0.0
    for k in range(2):
        score[scatter.mask] = basis[k] * scatter.noise
        observed += float((score * _windows(score)).sum()) / scatter.variance
        products[scatter.mask] = (basis * basis[k]).T
        tied = products.reshape(-1, len(basis)).T @ _windows(products).reshape(-1, len(basis))
        expected += float(basis[k] @ basis[k] - (inverse * tied).sum())
    independent = float((basis[:2] ** 2).sum())
    if expected < _TELLING * independent or scatter.variance <= 0:
        return 0.0, 0.0
    return observed / independent, expected / independent


def _windows(values: np.ndarray) -> np.ndarray:
    """Return the sums over the window around every pixel."""
    return np.asarray(
        cv2.boxFilter(values, -1, (_WINDOW, _WINDOW), normalize=False, borderType=cv2.BORDER_CONSTANT)
    )
