"""Exposure and sharpness of one picture, from its values alone."""

from dataclasses import dataclass

import cv2
import numpy as np
from jaxtyping import Bool, Float32, Float64, Shaped

_WINDOW = 15  # px: an edge's two sides lie within, unless it is blurred by more than some 4 px
_STRONG = 99.5  # percentile of the gradient that counts as a strong edge
_ABOVE_NOISE = 8.0  # contrast of an edge over the usual gradient between pixels
_STANDS_OUT = 5.0
"""Gradient of an edge over the usual one: of noise (Rayleigh) one pixel in 2^25 exceeds that."""
_DIRECTIONS = 4
_FEWEST_EDGES = 20


@dataclass(frozen=True)
class PictureQuality:
    """Exposure and sharpness of a picture.

    Attributes
    ----------
    median_level : float
        Median grey level as a share of full scale.
    saturated_share : float
        Share of pixels with a channel at full scale; these have lost what was brighter.
    sharpness : float
        Steepness of the strong edges, in shares of their contrast per pixel (1/px): see
        :func:`picture_quality`. NaN where there are no edges.
    """

    median_level: float
    saturated_share: float
    sharpness: float

    @property
    def edge_width_px(self) -> float:
        """The number of pixels over which an edge rises at its steepest rate; NaN without edges."""
        return 1.0 / self.sharpness


def picture_quality(picture: Shaped[np.ndarray, "*shape"]) -> PictureQuality:
    """Measure exposure and sharpness.

    Sharpness is the median, over the crests of the strongest gradients, of the gradient (central differences)
    over the contrast (greatest minus least level of a smoothed window around). It does not depend on
    brightness or contrast. A step blurred by a Gaussian of standard deviation s px gives
    ``erf(1 / (s sqrt(2))) / 2``, about ``0.4 / s`` from s = 1 on. A perfect step gives 0.5 along rows and
    columns and up to 0.7 across. Beyond s = 4 the window no longer holds the whole edge, and the figure is
    too large.

    Parameters
    ----------
    picture : ndarray, shape (h, w) or (h, w, 3)
        uint8, uint16, or float with full scale at 1.
    """
    grey = _grey(picture)
    return PictureQuality(
        median_level=float(np.median(grey)),
        saturated_share=float(saturated(picture).mean()),
        sharpness=_sharpness(grey),
    )


def saturated(picture: Shaped[np.ndarray, "*shape"]) -> Bool[np.ndarray, "h w"]:
    """Return a mask of pixels with a channel at full scale."""
    brightest = picture if picture.ndim == 2 else picture.max(axis=-1)  # noqa: PLR2004 - grey
    return np.asarray(brightest >= _full_scale(picture))


def _full_scale(picture: np.ndarray) -> float:
    """Return the greatest level that the kind of picture holds."""
    return float(np.iinfo(picture.dtype).max) if np.issubdtype(picture.dtype, np.integer) else 1.0


def edge_directions(picture: Shaped[np.ndarray, "*shape"]) -> Float64[np.ndarray, "4"]:
    """Return the widths of strong edges (px) by the direction in which they rise; NaN where there are few.

    Directions are 0, 45, 90 and 135 degrees from the rows, each with 22.5 degrees to both sides. Defocus
    makes edges of all directions as wide; motion only those that it crosses. A board of squares may have
    edges of two directions alone; in the others the noise beside its edges is none.

    Parameters
    ----------
    picture : ndarray, shape (h, w) or (h, w, 3)
    """
    edges = _Edges.of(_grey(picture))
    if edges is None:
        return np.full(_DIRECTIONS, np.nan)
    bins = np.round(edges.angle / (np.pi / _DIRECTIONS)).astype(np.int64) % _DIRECTIONS
    clear = edges.gradient > _STANDS_OUT * float(np.median(edges.gradient))
    widths = np.full(_DIRECTIONS, np.nan)
    for direction in range(_DIRECTIONS):
        of = edges.steepness(bins == direction, clear)
        if len(of) >= _FEWEST_EDGES:
            widths[direction] = 1.0 / np.median(of)
    return widths


@dataclass(frozen=True)
class _Edges:
    """Gradients of a picture without its border: values, angles, crests, and the contrast around."""

    gradient: Float32[np.ndarray, "h w"]
    angle: Float32[np.ndarray, "h w"]
    crest: Bool[np.ndarray, "h w"]
    contrast: Float32[np.ndarray, "h w"]

    @classmethod
    def of(cls, grey: Float32[np.ndarray, "rows columns"]) -> "_Edges | None":
        if min(grey.shape) <= _WINDOW:
            return None
        x = (grey[1:-1, 2:] - grey[1:-1, :-2]) / 2
        y = (grey[2:, 1:-1] - grey[:-2, 1:-1]) / 2
        gradient = np.hypot(x, y)
        window = np.ones((_WINDOW, _WINDOW), dtype=np.uint8)
        # Smoothed, since the extremes of noise are no contrast.
        smooth = cv2.blur(grey, (3, 3))
        contrast = (cv2.dilate(smooth, window) - cv2.erode(smooth, window))[1:-1, 1:-1]
        crest = gradient >= cv2.dilate(gradient, np.ones((3, 3), dtype=np.uint8))
        return cls(gradient, np.arctan2(y, x), crest, contrast)

    def steepness(
        self, among: Bool[np.ndarray, "h w"], clear: Bool[np.ndarray, "h w"]
    ) -> Float32[np.ndarray, " n"]:
        """Return the steepness of the strong edges among some pixels that are clear of noise, 1/px."""
        if not among.any():
            return np.zeros(0, dtype=np.float32)
        strong = among & clear & self.crest & (self.gradient > 0)
        strong &= self.gradient >= np.percentile(self.gradient[among], _STRONG) / 2
        strong &= self.contrast > _ABOVE_NOISE * float(np.median(self.gradient))
        return np.asarray(self.gradient[strong] / self.contrast[strong])


def _grey(picture: Shaped[np.ndarray, "*shape"]) -> Float32[np.ndarray, "h w"]:
    """Return grey levels as shares of full scale."""
    full = _full_scale(picture)
    # Green counts twice, so that the order of the colours does not matter.
    weights = np.array([0.25, 0.5, 0.25], dtype=np.float32) / full
    levels = picture / full if picture.ndim == 2 else picture @ weights  # noqa: PLR2004 - grey
    return np.asarray(np.nan_to_num(levels).astype(np.float32))


def _sharpness(grey: Float32[np.ndarray, "h w"]) -> float:
    """Return the steepness of strong edges, 1/px."""
    edges = _Edges.of(grey)
    if edges is None:
        return float("nan")
    everywhere = np.ones_like(edges.crest)
    steepness = edges.steepness(everywhere, everywhere)
    return float(np.median(steepness)) if len(steepness) else float("nan")
