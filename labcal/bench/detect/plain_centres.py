"""Centres of dots by common OpenCV methods: blobs, and ellipses through the contour of a threshold."""

import cv2
import numpy as np

from labcal.arrays import PixelCovariances, Pixels
from labcal.bench.detect.opencv_grid import blob_detector

_WINDOW = 1.5  # times the outline
_FEWEST = 5  # points that an ellipse needs


def blob_centres(picture: np.ndarray, near: Pixels, shape: PixelCovariances) -> Pixels:
    """Return the blob of ``cv2.SimpleBlobDetector`` within each dot that is nearest to its middle; else NaN.

    Parameters
    ----------
    picture : ndarray of uint8, shape (height, width)
    near : ndarray, shape (n, 2)
        Where the dots are, px.
    shape : ndarray, shape (n, 2, 2)
        S of their outlines, px squared.
    """
    axes = np.sqrt(np.linalg.eigvalsh(shape))
    blobs = cv2.KeyPoint.convert(blob_detector(float(axes.min()), float(axes.max())).detect(picture))
    found = np.full_like(near, np.nan)
    if len(blobs) == 0:
        return found
    places = np.asarray(blobs, dtype=np.float64).reshape(-1, 2)
    away = np.linalg.norm(near[:, None] - places[None], axis=-1)
    nearest = away.argmin(axis=1)
    inside = away.min(axis=1) < 0.5 * axes[:, 0]
    found[inside] = places[nearest[inside]]
    return found


def contour_centres(picture: np.ndarray, near: Pixels, shape: PixelCovariances) -> Pixels:
    """Return the centre of ``cv2.fitEllipse`` through the longest contour around each dot; else NaN.

    Each dot has a threshold of its own, by Otsu's method.

    Parameters
    ----------
    picture : ndarray of uint8, shape (height, width)
    near : ndarray, shape (n, 2)
        Where the dots are, px.
    shape : ndarray, shape (n, 2, 2)
        S of their outlines, px squared.
    """
    found = np.full_like(near, np.nan)
    limit = np.array(picture.shape[::-1])
    for number, (centre, S) in enumerate(zip(near, shape, strict=True)):
        extent = _WINDOW * np.sqrt(np.diag(S))
        low = np.maximum(np.floor(centre - extent), 0).astype(int)
        high = np.minimum(np.ceil(centre + extent) + 1, limit).astype(int)
        window = np.ascontiguousarray(picture[low[1] : high[1], low[0] : high[0]])
        _, dark = cv2.threshold(window, 0, 255, cv2.THRESH_BINARY_INV + cv2.THRESH_OTSU)
        contours, _ = cv2.findContours(dark, cv2.RETR_EXTERNAL, cv2.CHAIN_APPROX_NONE)
        longest = max(contours, key=len, default=np.zeros((0, 1, 2), np.int32))
        if len(longest) >= _FEWEST:
            found[number] = np.array(cv2.fitEllipse(longest)[0]) + low
    return found
