"""The noise of the renderer itself in the positions of dots: a pixel is the mean of finitely many rays."""

import numpy as np
from jaxtyping import Float64

from labcal.guide.rehearsal.dot_noise import DotNoise

_SIGMA_PX, _RAYS, _SIZE_PX = 0.0039, 64.0, 5.3
"""Standard deviation of a coordinate of a dot of that minor semi-axis at so many rays a pixel."""
_BY_RAYS = -0.75
"""Power of the standard deviation by the number of rays: that of a (0, 2)-sequence along an edge."""
_BY_SIZE = -0.6
"""Power of the standard deviation by the size; the longer an outline, the more pixels tell of it."""


def renderer_sigma(size_px: Float64[np.ndarray, " n"], spp: int) -> Float64[np.ndarray, " n"]:
    """Return the standard deviation of a coordinate of rendered dots by finitely many rays, px.

    Parameters
    ----------
    size_px : ndarray, shape (n,)
        Minor semi-axes of the dots.
    spp : int
        Rays a pixel.

    Notes
    -----
    From pictures without noise that were rendered twice with other rays
    (``docs/decisions/2026-11-27-a-forecast-has-errors-of-shape-and-of-place.md``).
    """
    by_size = (size_px / _SIZE_PX) ** _BY_SIZE
    return np.asarray(_SIGMA_PX * (spp / _RAYS) ** _BY_RAYS * by_size)


def rendered_noise(dots: DotNoise, spp: int) -> DotNoise:
    """Return the noise of dots in pictures that are rendered with so many rays a pixel."""
    own = float(renderer_sigma(np.array([dots.size_px]), spp)[0]) ** 2
    return DotNoise(dots.size_px, dots.variance + own, dots.power)
