"""Dark spots of a picture at every scale: a first, rough look for dots."""

from dataclasses import dataclass

import cv2
import numpy as np

from labcal.arrays import Mask, PixelCovariances, Pixels
from labcal.detect.grey import GreyPicture

# Half the window, in pixels of a pyramid level, over which the darkest and brightest value set the threshold.
# A dot larger than that is found by the dark band along its edge, or whole in a coarser level.
_REACH = 9
_SMALLEST_LEVEL = 12  # px: coarser levels hold nothing that could be a grid
_MIN_CONTOUR = 6  # points: fewer cannot tell an ellipse
_MIN_MINOR = 1.2  # px of the level
_MIN_ASPECT = 0.2  # a disc seen at 78 degrees
_LARGEST = 0.2  # semi-axis over the picture's longer side
_NOISE_FACTOR = 8.0  # the range of noise alone in one window is 6 to 7 standard deviations
_MIN_CONTRAST = 0.05  # of the picture's range
_EXPANSION = 0.5  # px: contours run through the centres of the outermost pixels


@dataclass(frozen=True)
class Blobs:
    """Dark spots: rough centres (px), outline matrices (see `PictureDots.outline`), and whether the frame cuts them."""

    centre: Pixels
    shape: PixelCovariances
    cut: Mask


def find_blobs(grey: GreyPicture) -> Blobs:
    """Return every dark spot that is roughly an ellipse, or cut by the frame, from all pyramid levels.

    A spot may occur several times, once a level. There is no size to set: levels are halved until nothing
    is left of the picture, and the threshold follows the surroundings, so that light may fall off.
    """
    centres: list[np.ndarray] = []
    shapes: list[np.ndarray] = []
    cuts: list[bool] = []
    level, scale = grey, 1.0
    low, high = np.percentile(grey[:: 1 + grey.shape[0] // 256, :: 1 + grey.shape[1] // 256], [0.5, 99.5])
    while min(level.shape) >= _SMALLEST_LEVEL:
        for contour in _dark_contours(level, _MIN_CONTRAST * float(high - low)):
            blob = _blob(contour, level.shape)
            if blob is not None:
                centre, shape, cut = blob
                centres.append((centre + 0.5) * scale - 0.5)
                shapes.append(shape * scale**2)
                cuts.append(cut)
        height, width = level.shape[0] // 2, level.shape[1] // 2
        level = cv2.resize(level[: 2 * height, : 2 * width], (width, height), interpolation=cv2.INTER_AREA)
        scale *= 2
    return Blobs(
        np.array(centres, dtype=np.float64).reshape(-1, 2),
        np.array(shapes, dtype=np.float64).reshape(-1, 2, 2),
        np.array(cuts, dtype=bool),
    )


def _dark_contours(level: np.ndarray, min_contrast: float) -> list[np.ndarray]:
    """Return the outer contours of what is darker than half-way between the local extremes."""
    smooth = cv2.GaussianBlur(level, (3, 3), 0.8)
    window = np.ones((2 * _REACH + 1, 2 * _REACH + 1), np.uint8)
    bright, dark = cv2.dilate(smooth, window), cv2.erode(smooth, window)
    contrast = np.maximum(_NOISE_FACTOR * _noise(smooth), min_contrast)
    mask = ((2 * smooth < bright + dark) & (bright - dark > contrast)).astype(np.uint8)
    contours, hierarchy = cv2.findContours(mask, cv2.RETR_CCOMP, cv2.CHAIN_APPROX_NONE)
    if hierarchy is None:
        return []
    outer = hierarchy.reshape(-1, 4)[:, 3] < 0
    return [
        contour.reshape(-1, 2)
        for contour, keep in zip(contours, outer, strict=True)
        if keep and len(contour) >= _MIN_CONTOUR
    ]


def _noise(level: np.ndarray) -> float:
    """Return the standard deviation of the noise, from second differences, which smooth shading leaves alone."""
    step = 1 + max(level.shape) // 512
    rows = level[::step]
    difference = rows[:, 2:] - 2 * rows[:, 1:-1] + rows[:, :-2]
    return float(np.median(np.abs(difference))) / (0.6745 * 6**0.5)


def _blob(contour: np.ndarray, size: tuple[int, ...]) -> tuple[np.ndarray, np.ndarray, bool] | None:
    """Return centre, outline matrix and whether the frame cuts it; None where it cannot be a dot."""
    low, high = contour.min(axis=0), contour.max(axis=0)
    if (high - low).max() > 2 * _LARGEST * max(size):
        return None
    if low.min() <= 0 or high[0] >= size[1] - 1 or high[1] >= size[0] - 1:
        half = (high - low + 1) / 2
        return (low + high) / 2, np.diag(half**2), True
    moments = cv2.moments(contour)
    area = moments["m00"]
    if area <= 0:
        return None
    centre = np.array([moments["m10"], moments["m01"]]) / area
    mixed = moments["mu11"] / area
    shape = 4 * np.array([[moments["mu20"] / area, mixed], [mixed, moments["mu02"] / area]])
    eigenvalues, vectors = np.linalg.eigh(shape)
    if eigenvalues[0] <= 0:
        return None
    axes = np.sqrt(eigenvalues)
    grown = axes + _EXPANSION
    if grown[0] < _MIN_MINOR or grown[0] < _MIN_ASPECT * grown[1]:
        return None
    radii = np.linalg.norm((contour - centre) @ vectors / axes, axis=1)
    if radii.std() > 0.1 + 0.35 / grown[0]:
        return None
    return centre, (vectors * grown**2) @ vectors.T, False
