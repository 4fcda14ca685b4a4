"""ArUco markers and AprilTags in one picture: named by OpenCV, their corners placed by a fit of our own."""

import cv2
import numpy as np

from labcal.detect.corners.corner_fit import is_cut
from labcal.detect.edges.noise import noise_factor
from labcal.detect.grey import AnyPicture, GreyPicture, grey_picture
from labcal.detect.marks.picture_marks import MarkFlag, PictureMarks, SeenMark, collected
from labcal.detect.marks.tag_corner import TagCorner, fit_tag_corner
from labcal.detect.settings import DEFAULTS, DetectSettings
from labcal.targets.charuco import MarkerDictionary
from labcal.targets.charuco_opencv import opencv_dictionary

_SHADINGS = 1.3  # of a fit's four for the light, spent on the flat parts, as for a chessboard
_NO_OUTLINE = np.full((2, 2), np.nan)


def tag_name(dictionary: MarkerDictionary) -> str:
    """Return the name of a dictionary in the names of points: ``apriltag-36h11``, ``aruco-5x5-100``."""
    name = dictionary.value.removeprefix("DICT_").lower().replace("_", "-")
    return name if name.startswith(("apriltag", "aruco")) else f"aruco-{name}"


def find_tags(
    image: AnyPicture, dictionary: MarkerDictionary, settings: DetectSettings | None = None
) -> PictureMarks:
    """Find the tags of a dictionary in one picture, black on white, with their four corners.

    Parameters
    ----------
    image : ndarray, shape (h, w), (h, w, 3) or (h, w, 4)
        uint8, uint16 or float; colour in any order.
    dictionary : MarkerDictionary
        OpenCV's name of the set of tags.
    settings : DetectSettings, optional
        Thresholds of the fit of corners; the defaults where not given.

    Returns
    -------
    PictureMarks
        Points named ``DICTIONARY-TAG-CORNER``, such as ``apriltag-36h11-17-0``. Corners are those of the
        black border, 0 to 3 clockwise from the upper left one of the tag as it is printed.

    Raises
    ------
    InputTypeError, InputError
        `image` is no picture (see :func:`labcal.detect.grey.grey_picture`).
    """
    settings = DEFAULTS if settings is None else settings
    grey = grey_picture(image)
    size = (grey.shape[1], grey.shape[0])
    name, cells = tag_name(dictionary), opencv_dictionary(dictionary).markerSize + 2
    rough = [
        (f"{name}-{tag}-{corner}", _surroundings(quad, corner, cells))
        for tag, quad in recognised_tags(grey, dictionary, settings)
        for corner in range(4)
    ]
    fits = [fit_tag_corner(grey, corner, settings.corner) for _, corner in rough]
    limit = settings.corner.roughness_factor * _median([fit.roughness for fit in fits if fit is not None])
    sums = [fit.sums for fit in fits if fit is not None]
    factor = noise_factor(np.array(sums), settings.edge, _SHADINGS) if sums else 1.0
    marks = []
    for (point, corner), fit in zip(rough, fits, strict=True):
        if fit is not None and fit.roughness < limit + settings.corner.roughness_share:
            placed = (fit.centre, factor * fit.covariance)
            marks.append(SeenMark(point, MarkFlag.OK, fit.centre, _NO_OUTLINE, *placed))
        else:
            cut = is_cut(corner.centre, grey, settings.corner.frame_margin_px)
            flag = MarkFlag.CUT if cut else MarkFlag.BAD_FIT
            marks.append(SeenMark(point, flag, corner.centre, _NO_OUTLINE))
    return collected(marks, size)


def _median(values: list[float]) -> float:
    """Return the median, 0 of nothing."""
    return float(np.median(values or [0.0]))


def recognised_tags(
    grey: GreyPicture, dictionary: MarkerDictionary, settings: DetectSettings, border_cells: int = 1
) -> list[tuple[int, np.ndarray]]:
    """Return the tags that OpenCV recognises, each with its corners roughly in place, (4, 2).

    Corners run clockwise from the upper left one of OpenCV's picture of the tag.
    """
    limits = settings.corner
    large_enough = min(grey.shape) >= limits.min_picture_px
    cut = limits.range_cut_percent
    low, high = np.percentile(grey, [cut, 100.0 - cut]) if large_enough else (0.0, 0.0)
    if high <= low:
        return []
    bytes_ = np.clip((grey - low) * (255.0 / (high - low)), 0, 255).astype(np.uint8)
    parameters = cv2.aruco.DetectorParameters()
    parameters.markerBorderBits = border_cells
    parameters.minMarkerPerimeterRate = min(0.03, 4.0 * limits.min_marker_px / max(grey.shape))
    corners, ids, _ = cv2.aruco.ArucoDetector(opencv_dictionary(dictionary), parameters).detectMarkers(bytes_)
    numbers: list[int] = [] if ids is None else np.asarray(ids, dtype=np.int64).ravel().tolist()
    quads = [np.asarray(quad, dtype=np.float64).reshape(4, 2) for quad in corners]
    return list(zip(numbers, quads, strict=True))


def _surroundings(quad: np.ndarray, corner: int, cells: int) -> TagCorner:
    """Return a corner of a tag with its edges, to the next corner and to the one before."""
    centre = quad[corner]
    edges = np.stack([quad[(corner + 1) % 4] - centre, quad[corner - 1] - centre], axis=1)
    return TagCorner(centre, edges, float(cells))
