"""The Bayer mosaic before a sensor: a pixel sees one colour, and its neighbours tell the other two.

What is computed so differs at edges by several times the noise. Only pictures of cameras that are known,
those of the rendered laboratory, can be put through it: no other camera tells how it computes colours.
"""

from collections.abc import Sequence
from dataclasses import replace

import numpy as np
from jaxtyping import Float32

from labcal.guide.twin.dot_windows import BlurredShare
from labcal.render.demosaic import demosaic, mosaic

_COLOURS = 3


def behind_mosaic(light: Sequence[Float32[np.ndarray, "h w"]]) -> list[Float32[np.ndarray, "h w"]]:
    """Return red, green and blue light as a camera with a Bayer mosaic delivers them.

    Parameters
    ----------
    light : sequence of three float32 arrays, (h, w)
        White-balanced.
    """
    seen = demosaic(mosaic(np.stack(list(light), axis=-1)))
    return [np.ascontiguousarray(seen[..., colour]) for colour in range(_COLOURS)]


def green_behind_mosaic(behind: BlurredShare) -> BlurredShare:
    """Return a share of paper as green shows it behind a Bayer mosaic; its derivatives stay as they are."""
    # A mosaic before something grey changes nothing: all colours are alike.
    return replace(behind, share=np.ascontiguousarray(demosaic(behind.share)[..., 1]))
