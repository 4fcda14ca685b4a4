"""Differences of photograph and rendering in units of the noise, pixel by pixel."""

from dataclasses import dataclass

import numpy as np
from jaxtyping import Float32, UInt8

from labcal.guide.twin.again import RenderedAgain

_PURE = 1e-3
_SPECK = 6.0
"""In units of the noise; beyond it is dust, a scratch, or something that is not in the scene."""
_SHOWN = 5.0
"""Difference at which the colour of the residual picture is full, in units of the noise."""
_LEFT_OUT = 128


@dataclass(frozen=True)
class PixelFigures:
    """Differences of the pixels of one picture, over all channels.

    Attributes
    ----------
    pixels, edge_pixels : int
        That were compared, and those of them at the edges of dots.
    variance, flat_variance, edge_variance : float
        Mean squared difference in units of the variance of the noise: of all, of paper and ink, of edges. 1
        is noise alone.
    specks : int
        Pixels farther off than 6 standard deviations.
    """

    pixels: int
    edge_pixels: int
    variance: float
    flat_variance: float
    edge_variance: float
    specks: int

    @classmethod
    def of(cls, made: RenderedAgain) -> "PixelFigures":
        """Return the figures of a picture."""
        share, compared = made.behind.share, made.compared
        edge = (share > _PURE) & (share < 1.0 - _PURE)
        at_edges, on_flat = compared & edge, compared & ~edge
        squares = [z * z for z in normalised(made)]
        flat = np.concatenate([z2[on_flat] for z2 in squares]).astype(np.float64)
        rim = np.concatenate([z2[at_edges] for z2 in squares]).astype(np.float64)
        both = flat.size + rim.size
        return cls(
            pixels=both,
            edge_pixels=rim.size,
            variance=float((flat.sum() + rim.sum()) / max(1, both)),
            flat_variance=float(flat.mean()) if flat.size else float("nan"),
            edge_variance=float(rim.mean()) if rim.size else float("nan"),
            specks=int((flat > _SPECK**2).sum() + (rim > _SPECK**2).sum()),
        )


def normalised(made: RenderedAgain) -> list[Float32[np.ndarray, "h w"]]:
    """Return photograph minus rendering of each channel, in units of the noise."""
    found = []
    for photo, light, variance in zip(made.photo, made.clean(), made.variances(), strict=True):
        found.append((photo - light) / np.sqrt(variance))
    return found


def difference_picture(made: RenderedAgain) -> UInt8[np.ndarray, "h w 3"]:
    """Return the residual picture of the main channel: red where the photograph is lighter, else blue.

    White is no difference, full colour five standard deviations of the noise; what was not compared is grey.
    """
    z = np.clip(normalised(made)[made.main] / _SHOWN, -1.0, 1.0)
    fade = np.rint(255.0 * (1.0 - np.abs(z))).astype(np.uint8)
    full = np.full_like(fade, 255)
    picture = np.stack([np.where(z >= 0.0, full, fade), fade, np.where(z <= 0.0, full, fade)], axis=-1)
    picture[~made.compared] = _LEFT_OUT
    return picture
