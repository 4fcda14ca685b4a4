"""Dark spots of a picture at every scale: a first, rough look for dots."""

from dataclasses import dataclass, replace

import cv2
import numpy as np

from labcal.arrays import Mask, PixelCovariances, Pixels
from labcal.detect.grey import GreyPicture
from labcal.detect.matrices import eigenvalues, matrix_roots
from labcal.detect.outlines.contours import AREA, CENTRE, HIGH, LOW, SCATTER, SHAPE, contour_table
from labcal.detect.stage_settings.segmentation import SegmentationSettings

_ROWS_AT_ONCE = 512
_EXPANSION = 0.5  # px: contours run through the centres of the outermost pixels
_ROUND = np.array([1.0, 0.0, 1.0])
"""xx, xy and yy of any outline, where there is none."""


@dataclass(frozen=True)
class Blobs:
    """Dark spots: rough centres (px), outline matrices (as in `PictureDots`), whether the frame cuts them."""

    centre: Pixels
    shape: PixelCovariances
    cut: Mask


@dataclass(frozen=True)
class Level:
    """A picture halved some times, and the range of its grey values."""

    grey: GreyPicture
    scale: int
    """Pixels of the full picture along one of its own."""
    low: float
    high: float

    def in_8_bits(self) -> np.ndarray:
        """Return the picture with its range spread over 0 to 255, some rows at a time to spare memory."""
        factor = 255.0 / (self.high - self.low) if self.high > self.low else 0.0
        scaled = np.empty(self.grey.shape, dtype=np.uint8)
        for top in range(0, len(self.grey), _ROWS_AT_ONCE):
            rows = slice(top, top + _ROWS_AT_ONCE)
            above = self.grey[rows] - self.low
            np.maximum(above, 0.0, out=above)
            scaled[rows] = cv2.convertScaleAbs(above, alpha=factor)
        return scaled


class Pyramid:
    """The levels of a picture, the full one first, down to the coarsest that could show a grid.

    A level is computed when it is first asked for: most searches end at the level where they begin.

    Parameters
    ----------
    grey : ndarray, shape (h, w)
    settings : SegmentationSettings
    """

    def __init__(self, grey: GreyPicture, settings: SegmentationSettings) -> None:
        low, high = _range(grey, settings.range_cut_percent)
        self.scales = [1 << k for k in range(32) if min(grey.shape) >> k >= settings.smallest_level_px]
        self._levels = [Level(grey, 1, low, high)]

    def level(self, number: int) -> Level:
        """Return a level by the number of times that the picture is halved."""
        while len(self._levels) <= number:
            finer = self._levels[-1]
            height, width = finer.grey.shape[0] // 2, finer.grey.shape[1] // 2
            even = finer.grey[: 2 * height, : 2 * width]
            halved = cv2.resize(even, (width, height), interpolation=cv2.INTER_AREA)
            self._levels.append(replace(finer, grey=halved, scale=2 * finer.scale))
        return self._levels[number]


def blobs_of(level: Level, settings: SegmentationSettings) -> Blobs:
    """Return every dark spot of a level that is roughly an ellipse, or cut by the frame, in full pixels.

    There is no size to set: levels differ by two, and the threshold follows the surroundings, so that light
    may fall off.
    """
    contours = _dark_contours(level.in_8_bits(), settings)
    if not contours:
        return joined([])
    found, scale = _roughly_elliptic(contours, level.grey.shape, settings), float(level.scale)
    return Blobs((found.centre + 0.5) * scale - 0.5, found.shape * scale**2, found.cut)


def joined(parts: list[Blobs]) -> Blobs:
    """Return the blobs of several levels; a spot may occur several times, once a level."""
    none = Blobs(np.zeros((0, 2)), np.zeros((0, 2, 2)), np.zeros(0, dtype=bool))
    return Blobs(
        np.concatenate([none.centre, *(part.centre for part in parts)]),
        np.concatenate([none.shape, *(part.shape for part in parts)]),
        np.concatenate([none.cut, *(part.cut for part in parts)]),
    )


def _range(grey: GreyPicture, cut_percent: float) -> tuple[float, float]:
    """Return a low and a high grey value, a few outliers left aside."""
    sample = grey[:: 1 + grey.shape[0] // 128, :: 1 + grey.shape[1] // 128]
    if sample.size == 0:
        return 0.0, 0.0
    low, high = np.percentile(sample, [cut_percent, 100.0 - cut_percent])
    return float(low), float(high)


def _dark_contours(level: np.ndarray, settings: SegmentationSettings) -> list[np.ndarray]:
    """Return the outer contours (n, 1, 2) of what is darker than half-way between the local extremes."""
    smooth = cv2.GaussianBlur(level, (3, 3), settings.smoothing_px)
    side, busy_side = 2 * settings.threshold_reach_px + 1, 2 * settings.texture_reach_px + 1
    window = np.ones((side, side), np.uint8)
    bright, dark = cv2.dilate(smooth, window), cv2.erode(smooth, window)
    contrast = max(settings.min_contrast_sigma * _noise(smooth), 255.0 * settings.min_contrast_share)
    middle = cv2.addWeighted(bright, 0.5, dark, 0.5, 0.0)
    mask = ((smooth < middle) & (cv2.subtract(bright, dark) > contrast)).astype(np.uint8)
    if _changes(mask[:: settings.texture_reach_px]).mean() > 0.5 * settings.max_texture_share:
        mask &= (
            cv2.blur(_changes(mask).astype(np.float32), (busy_side, busy_side)) < settings.max_texture_share
        )
    contours, hierarchy = cv2.findContours(mask, cv2.RETR_CCOMP, cv2.CHAIN_APPROX_NONE)
    if hierarchy is None:
        return []
    parents, least = hierarchy.reshape(-1, 4)[:, 3].tolist(), settings.min_contour_points
    return [
        contour
        for contour, parent in zip(contours, parents, strict=True)
        if parent < 0 and len(contour) >= least
    ]


def _changes(mask: np.ndarray) -> np.ndarray:
    """Return where a mask differs from its neighbour to the right."""
    changes = np.zeros(mask.shape, dtype=bool)
    np.not_equal(mask[:, 1:], mask[:, :-1], out=changes[:, :-1])
    return changes


def _noise(level: np.ndarray) -> float:
    """Return the standard deviation of the noise from second differences, blind to smooth shading."""
    rows = level[:: 1 + level.shape[0] // 96].astype(np.int16)
    difference = rows[:, 2:] - 2 * rows[:, 1:-1] + rows[:, :-2]
    below = np.cumsum(np.bincount(np.abs(difference).ravel()))  # few values: faster than sorting them
    middle = np.searchsorted(below, [(difference.size - 1) // 2, difference.size // 2], side="right")
    return float(middle.mean()) / (0.6745 * 6**0.5)


def _roughly_elliptic(
    contours: list[np.ndarray], size: tuple[int, ...], settings: SegmentationSettings
) -> Blobs:
    """Return the contours that could be dots, and those that the frame cuts."""
    ends = np.cumsum([len(contour) for contour in contours])
    found = contour_table(np.concatenate(contours).reshape(-1, 2), ends)
    low, high = found[:, LOW], found[:, HIGH]
    middle, half = (low + high) / 2, (high - low + 1) / 2
    small = half.max(axis=1) <= settings.max_axis_share * max(size)
    cut = small & ((low <= 0).any(axis=1) | (high >= np.array(size[::-1]) - 1).any(axis=1))
    sound = small & ~cut & (found[:, AREA] > 0)
    shape = np.where(sound[:, None], found[:, SHAPE], _ROUND)[:, [0, 1, 1, 2]].reshape(-1, 2, 2)
    grown = np.sqrt(np.maximum(eigenvalues(shape), 0.0)) + _EXPANSION
    sound &= grown[:, 0] >= settings.min_spot_axis_px
    sound &= grown[:, 0] >= settings.min_axis_ratio_share * grown[:, 1]
    limit = settings.max_contour_scatter_share + settings.max_contour_scatter_px / grown[:, 0]
    sound &= found[:, SCATTER] <= limit
    kept = sound | cut
    # With semi-axes that are longer by _EXPANSION.
    outline = shape + 2.0 * _EXPANSION * matrix_roots(shape) + _EXPANSION**2 * np.eye(2)
    boxes = half[:, :, None] ** 2 * np.eye(2)
    return Blobs(
        np.where(cut[:, None], middle, found[:, CENTRE])[kept],
        np.where(cut[:, None, None], boxes, outline)[kept],
        cut[kept],
    )
