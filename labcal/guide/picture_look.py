"""Exposure and sharpness of a picture where the target is: one place for all who judge pictures."""

from dataclasses import dataclass

import cv2
import numpy as np
from jaxtyping import Float64, Shaped

from labcal.detect.dots import PictureDots
from labcal.detect.flags import DotFlag, Refusal
from labcal.shoot.quality import edge_directions, picture_quality, saturated

_PAPER, _INK = 90.0, 5.0
"""Percentiles of the levels of paper and ink where the target is."""
_LIGHTEST, _DARKEST = 99.0, 1.0
"""The same where the target is a part of the picture that is not known."""
_AROUND_PX = 8
_LEAST = 3
"""Dots that span an area."""
BURNT_SHARE = 0.01
"""Share of the target at full scale from which on edges of dots are cut off."""
FLAT = 0.3
"""Contrast between paper and ink, as a share of full scale, below which noise of dots counts."""
DIM = 0.42
"""Level of paper below which noise of dots counts at any contrast: some 40% more than at full exposure.

In drawn pictures with the tone curve of sRGB, two stops below three quarters of the range.
"""
_SATURATED_DOTS = 0.1
"""Share of saturated dots from which on a picture is burnt out."""
_BRIGHT = 0.6
"""Level of paper that is not dark."""
_SMALL_CONTRAST = 0.12
"""Contrast of a refused picture below which darkness is the reason."""
MOTION = 1.5
"""Ratio of the widths of edges across and along from which on a blur is one of motion."""


@dataclass(frozen=True)
class PictureLook:
    """Exposure and sharpness in the part of a picture that the dots span; of all of it if there are too few.

    Attributes
    ----------
    paper, ink : float
        Levels of the light and the dark parts, shares of full scale.
    burnt_share : float
        Share of pixels at full scale.
    edge_width_px : float
        NaN where there are no edges.
    directions_px : float64 array, (4,)
        Widths of edges that rise along 0, 45, 90 and 135 degrees from the rows; NaN where there are few.
    sigma_px : float
        Median standard deviation of the measured dots; NaN where none is measured.
    refusal : Refusal or None
    saturated_dots : float
        Share of the dots that were seen but are flagged as saturated.
    size : (int, int)
        Width and height of the picture, px.
    """

    paper: float
    ink: float
    burnt_share: float
    edge_width_px: float
    directions_px: Float64[np.ndarray, "4"]
    sigma_px: float
    refusal: Refusal | None
    saturated_dots: float
    size: tuple[int, int]

    @property
    def burnt(self) -> bool:
        """True if too much of the target is at full scale."""
        return (
            self.refusal is Refusal.SATURATED
            or self.burnt_share > BURNT_SHARE
            or self.saturated_dots > _SATURATED_DOTS
        )

    @property
    def dark(self) -> bool:
        """True if paper is dim, or ink and paper hardly differ."""
        contrast = self.paper - self.ink
        if self.refusal is not None:
            return self.paper < DIM and contrast < _SMALL_CONTRAST  # a grey wall is not dark
        return self.paper < DIM or (self.paper < _BRIGHT and contrast < FLAT)  # blurred paper is flat, too

    @property
    def widest_px(self) -> float:
        """Width of the edges of the direction in which they are widest; NaN where there are none.

        Dots have edges of all directions. Where no target is found and a direction has none, the others are
        those of something else (a board seen edge-on), and all edges together count.
        """
        if not np.isfinite(self.edge_width_px):
            return float("nan")
        known = np.isfinite(self.directions_px)
        if self.refusal is not None and not known.all():
            return self.edge_width_px
        return float(max([*self.directions_px[known].tolist(), self.edge_width_px]))

    @property
    def motion_deg(self) -> float | None:
        """Direction of a blur of motion, degrees from the rows; None where edges are alike."""
        widths = self.directions_px
        if not np.isfinite(widths).all():
            return None
        worst = int(np.argmax(widths))
        along = float(widths[(worst + 2) % 4])
        return 45.0 * worst if widths[worst] > MOTION * along else None

    @property
    def exposure_words(self) -> str | None:
        """The fault of the exposure in words; None where it is right."""
        if self.burnt:
            return f"burnt out: {self.burnt_share:.1%} of the target is at full scale"
        if self.dark and self.refusal is not None:
            return f"dark all over: levels from {self.ink:.0%} to {self.paper:.0%} of the range"
        if self.dark:
            return f"too dark: paper at {self.paper:.0%} and ink at {self.ink:.0%} of the range"
        return None


def look_at(picture: Shaped[np.ndarray, "*shape"], dots: PictureDots) -> PictureLook:
    """Return exposure and sharpness where the target is.

    Parameters
    ----------
    picture : ndarray, shape (h, w) or (h, w, 3)
        As read from its file.
    dots : PictureDots
        As measured in it.
    """
    part, inside = _spanned(picture, dots)
    quality = picture_quality(part)
    levels = part if part.ndim == 2 else part.mean(axis=-1)  # noqa: PLR2004 -- grey
    full = float(np.iinfo(part.dtype).max) if np.issubdtype(part.dtype, np.integer) else 1.0
    ranks = [_DARKEST, _LIGHTEST] if part is picture else [_INK, _PAPER]
    ink, paper = np.percentile(levels[inside], ranks) / full
    ok = dots.ok
    sigma = np.sqrt(np.trace(dots.covariance[ok], axis1=1, axis2=2) / 2.0) if ok.any() else np.array([np.nan])
    saturated_dots = float(np.mean([flag is DotFlag.SATURATED for flag in dots.flag])) if dots.flag else 0.0
    return PictureLook(
        paper=float(paper),
        ink=float(ink),
        burnt_share=float(saturated(part)[inside].mean()),
        edge_width_px=quality.edge_width_px,
        directions_px=edge_directions(part),
        sigma_px=float(np.median(sigma)),
        refusal=dots.refusal,
        saturated_dots=saturated_dots,
        size=dots.size,
    )


def _spanned(picture: np.ndarray, dots: PictureDots) -> tuple[np.ndarray, np.ndarray]:
    """Return the part of a picture around the dots, and a mask of what is within their hull."""
    height, width = picture.shape[:2]
    seen = dots.seen_at[np.isfinite(dots.seen_at).all(axis=1)]
    if dots.refusal is not None or len(seen) < _LEAST:
        return picture, np.ones((height, width), dtype=bool)
    low = np.maximum(np.floor(seen.min(axis=0)).astype(int) - _AROUND_PX, 0)
    high = np.minimum(np.ceil(seen.max(axis=0)).astype(int) + _AROUND_PX, [width, height])
    part = picture[low[1] : high[1], low[0] : high[0]]
    hull = cv2.convexHull((seen - low).astype(np.float32)).astype(np.int32)
    mask = cv2.fillConvexPoly(np.zeros(part.shape[:2], dtype=np.uint8), hull, 1)
    return part, mask.astype(bool) if mask.any() else np.ones(part.shape[:2], dtype=bool)
