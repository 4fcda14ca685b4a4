"""``cv2.findCirclesGrid`` on the pictures of the suite, with suitable blob parameters."""

from typing import cast

import cv2
import numpy as np

from labcal.bench.detect.dot_visibility import DotVisibility
from labcal.targets.grid import DotGrid

MODES = {
    "symmetric": cv2.CALIB_CB_SYMMETRIC_GRID,
    "symmetric, clustering": cv2.CALIB_CB_SYMMETRIC_GRID | cv2.CALIB_CB_CLUSTERING,
}
OFF_PX = 3.0
"""A dot of OpenCV's is where a true one is within this."""
MOST_BLOBS = 3.0
"""With more blobs than this, as a multiple of the dots, its search takes minutes; it counts as failed."""


def blob_detector(least_px: float, most_px: float) -> cv2.SimpleBlobDetector:
    """Return OpenCV's blob detector for dots of some radii.

    By area only: the filter of colour refuses rings, that of convexity small dots; inertia and circularity
    are let down to what a tilt of 70 degrees leaves.

    Parameters
    ----------
    least_px, most_px : float
        Least minor and greatest major semi-axis, px.
    """
    parameters = cv2.SimpleBlobDetector.Params()
    parameters.filterByColor = False
    parameters.filterByConvexity = False
    parameters.filterByCircularity = True
    parameters.minCircularity = 0.5
    parameters.filterByInertia = True
    parameters.minInertiaRatio = 0.08
    parameters.minArea = float(0.5 * np.pi * least_px**2)
    parameters.maxArea = float(2.0 * np.pi * most_px**2)
    parameters.minDistBetweenBlobs = float(1.5 * least_px)
    return cv2.SimpleBlobDetector.create(parameters)


def finds_grid(picture: np.ndarray, target: DotGrid, seen: DotVisibility, flags: int) -> bool:
    """Tell whether OpenCV finds the grid, with every dot at a true one, whatever its number.

    Parameters
    ----------
    picture : ndarray of uint8
    target : DotGrid
    seen : DotVisibility
    flags : int
        Of :data:`MODES`.
    """
    grey = picture if picture.ndim == 2 else cv2.cvtColor(picture, cv2.COLOR_RGB2GRAY)  # noqa: PLR2004 -- grey
    least, most = float(np.nanmin(seen.minor_px)), 0.5 * float(np.nanmax(seen.pitch_px))
    blobs = cv2.KeyPoint.convert(blob_detector(least, most).detect(grey))
    if not target.count <= len(blobs) <= MOST_BLOBS * target.count:
        return False
    found, dots = cv2.findCirclesGrid(
        np.asarray(blobs, dtype=np.float32).reshape(-1, 1, 2),
        (target.cols, target.rows),
        flags,
        cast("cv2.Feature2D", None),  # no detector: what is given are the blobs
        cv2.CirclesGridFinderParameters(),
    )
    if not found or dots is None:
        return False
    away = np.linalg.norm(dots.reshape(-1, 1, 2) - seen.centroid[None], axis=-1)
    return bool((np.nanmin(away, axis=1) <= OFF_PX).all())
