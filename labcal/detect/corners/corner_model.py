"""The picture of one corner, of a chessboard or of a tag: two blurred edges, with the light's slope."""

from dataclasses import dataclass, field

import numpy as np
from jaxtyping import Float64

from labcal.detect.corners.corner_kernel import CHESSBOARD, PARAMETERS, Pixels, fill_jacobian


@dataclass(frozen=True)
class CornerPixels:
    """The pixels of a fit.

    Attributes
    ----------
    mask : ndarray of bool, shape (h, w)
        Which pixels of their rectangle are used.
    offset : ndarray, shape (2, n)
        From where the fit begins, px.
    value : ndarray, shape (n,)
        Grey values.
    gap : ndarray, shape (2,)
        From the corner's edges to those of the markers, px.
    pattern : int
        :data:`~labcal.detect.corners.corner_kernel.CHESSBOARD` or
        :data:`~labcal.detect.corners.corner_kernel.WEDGE`.
    bend : ndarray, shape (2,)
        Curvature of either edge towards its normal, 1/px, as a lens bends it; taken for known.
    tone : float
        The c of the :mod:`~labcal.detect.corners.tone_curve` of the pattern; taken for known.
    """

    mask: np.ndarray
    offset: np.ndarray
    value: np.ndarray
    gap: np.ndarray
    pattern: int = CHESSBOARD
    bend: np.ndarray = field(default_factory=lambda: np.zeros(2))
    tone: float = 0.0

    @property
    def arrays(self) -> Pixels:
        """The same for compiled code."""
        return np.ascontiguousarray(self.offset), self.value, self.gap, self.bend, self.pattern, self.tone


@dataclass(frozen=True)
class LinearisedCorner:
    """Residuals and derivatives by corner 2, angles of normals 2, blurs 2, mean, half step, slope 2."""

    residual: Float64[np.ndarray, " n"]
    jacobian: Float64[np.ndarray, "parameters n"]
    board: Float64[np.ndarray, " n"]
    """The modelled pattern, from -1 (black) to 1 (white), as the tone curve shows it."""
    off_edges: Float64[np.ndarray, " n"]
    """The smaller distance of every pixel from the two edges, in blurs."""


def linearise(state: Float64[np.ndarray, " parameters"], window: CornerPixels) -> LinearisedCorner:
    """Return residuals and derivatives at a state.

    The formula stands at :func:`~labcal.detect.corners.corner_fit.fit_corner`.

    Parameters
    ----------
    state : ndarray, shape (PARAMETERS,)
    window : CornerPixels
    """
    n = len(window.value)
    rows = (np.empty(n), np.empty((PARAMETERS, n)), np.empty(n), np.empty(n))
    fill_jacobian(state, window.arrays, rows)
    return LinearisedCorner(*rows)
