"""Checks of the corners of tags on drawn pictures, beside those of OpenCV on the same pictures."""

from dataclasses import dataclass

import cv2
import numpy as np

from labcal.bench.detect.accuracy import over_bound
from labcal.bench.groups import Bench, Findings
from labcal.bench.marks.drawn_picture import Exposure, drawn, tilted
from labcal.detect.marks.tags import find_tags, tag_name
from labcal.report.bench import Figure, at_most
from labcal.rng import generator
from labcal.targets.charuco import MarkerDictionary
from labcal.targets.charuco_opencv import opencv_dictionary

PICTURES, QUICK_PICTURES = 60, 6
DICTIONARY = MarkerDictionary.DICT_APRILTAG_36H11
SIZE = (400, 300)
ACROSS = 3
"""Tags along either side of a sheet."""
PITCH = 1.4
"""From tag to tag, in sides of a tag: a quiet zone of more than a cell."""
SIDE_PX = (28.0, 70.0)
TILT_DEG = (0.0, 50.0)
BLUR_PX, NOISE = (0.6, 1.4), (0.008, 0.03)
FOCAL_PX = 520.0
MOST_OF_OPENCV = 0.5
OFF_PX = 5.0
REFINEMENTS = {
    "no refinement": cv2.aruco.CORNER_REFINE_NONE,
    "sub-pixel refinement": cv2.aruco.CORNER_REFINE_SUBPIX,
    "contour refinement": cv2.aruco.CORNER_REFINE_CONTOUR,
    "AprilTag refinement": cv2.aruco.CORNER_REFINE_APRILTAG,
}
"""OpenCV's ways to place corners."""


@dataclass(frozen=True)
class TagPicture:
    """A picture of tags, and its true corners by name."""

    picture: np.ndarray
    corners: dict[str, np.ndarray]


def tag_picture(number: int, seed: int) -> TagPicture:
    """Draw one picture of nine tags; each quantity is drawn from its range.

    Parameters
    ----------
    number : int
        Of the picture.
    seed : int
    """
    random = generator(seed, "bench marks", "tags", f"picture {number}")
    side, tilt = random.uniform(*SIDE_PX), np.radians(random.uniform(*TILT_DEG))
    azimuth, roll, direction = random.uniform(-np.pi, np.pi, 3).tolist()
    x, y = (np.array(SIZE) / 2.0 + random.uniform(-0.5, 0.5, 2)).tolist()
    H = tilted(float(tilt), azimuth, roll, float(FOCAL_PX / side), FOCAL_PX)
    H = np.array([[1.0, 0.0, x], [0.0, 1.0, y], [0.0, 0.0, 1.0]]) @ H
    gradient = random.uniform(0.0, 0.003) * np.array([np.cos(direction), np.sin(direction)])
    exposure = Exposure(SIZE, H, random.uniform(*BLUR_PX), gradient, random.uniform(*NOISE))
    tags = random.permutation(DICTIONARY.size)[: ACROSS**2]
    dictionary = opencv_dictionary(DICTIONARY)
    cells = dictionary.markerSize + 2
    black = np.stack([dictionary.generateImageMarker(int(tag), cells, borderBits=1) == 0 for tag in tags])
    first = -0.5 * (ACROSS - 1) * PITCH

    def ink(x: np.ndarray, y: np.ndarray) -> np.ndarray:
        """Return 1 on black cells, else 0; y runs up."""
        col, row = (np.rint((place - first) / PITCH).astype(int) for place in (x, y))
        u, v = x - first - col * PITCH + 0.5, 0.5 - (y - first - row * PITCH)
        inside = (col >= 0) & (col < ACROSS) & (row >= 0) & (row < ACROSS)
        inside &= (u >= 0.0) & (u < 1.0) & (v >= 0.0) & (v < 1.0)
        i, j = (np.clip((cells * place).astype(int), 0, cells - 1) for place in (v, u))
        tag = np.where(inside, row * ACROSS + col, 0)
        return np.where(inside & black[tag, i, j], 1.0, 0.0)

    square = np.array([[-0.5, 0.5], [0.5, 0.5], [0.5, -0.5], [-0.5, -0.5]])
    corners: dict[str, np.ndarray] = {}
    for k, tag in enumerate(tags.tolist()):
        row, col = divmod(k, ACROSS)
        seen = exposure.seen(np.array([first + col * PITCH, first + row * PITCH]) + square)
        corners |= {f"{tag_name(DICTIONARY)}-{tag}-{corner}": seen[corner] for corner in range(4)}
    return TagPicture(drawn(exposure, ink, (), random), corners)


def tag_findings(bench: Bench) -> Findings:
    """Return the error of corners beside OpenCV's on the corners that all of them measured."""
    count = QUICK_PICTURES if bench.quick else PICTURES
    bench.progress.start("tags", count)
    errors: dict[str, list[np.ndarray]] = {name: [] for name in ("labcal", *REFINEMENTS)}
    covariances = []
    for number in range(count):
        picture = tag_picture(number, bench.seed)
        marks = find_tags(picture.picture, DICTIONARY)
        placed = {"labcal": {marks.point[k]: marks.position[k] for k in np.flatnonzero(marks.ok).tolist()}}
        placed |= {name: _opencv_corners(picture.picture, way) for name, way in REFINEMENTS.items()}
        shared = sorted(set(picture.corners).intersection(*placed.values()))
        for name, of in placed.items():
            errors[name] += [of[point] - picture.corners[point] for point in shared]
        covariances += [marks.covariance[marks.point.index(point)] for point in shared]
        bench.progress.advance()
    rms = {way: float(np.sqrt((np.array(of) ** 2).mean())) for way, of in errors.items()}
    best = min((rms[name] for name in REFINEMENTS), default=float("nan"))
    stated = over_bound(np.array(errors["labcal"]), np.array(covariances))
    name = f"{count} pictures of tags"
    return Findings(
        [
            at_most(f"{name}: RMS error of corners over OpenCV's best", rms["labcal"] / best, MOST_OF_OPENCV),
            at_most(f"{name}: RMS error over what is stated", stated, 1.2),
        ],
        [
            Figure(name=f"{name}: corners compared", value=float(len(covariances))),
            *(Figure(name=f"{name}: RMS of {way}, px per axis", value=value) for way, value in rms.items()),
        ],
    )


def _opencv_corners(picture: np.ndarray, refinement: int) -> dict[str, np.ndarray]:
    """Return the corners as OpenCV places them, by name."""
    parameters = cv2.aruco.DetectorParameters()
    parameters.cornerRefinementMethod = refinement
    detector = cv2.aruco.ArucoDetector(opencv_dictionary(DICTIONARY), parameters)
    corners, ids, _ = detector.detectMarkers(picture)
    numbers = [] if ids is None else np.asarray(ids).ravel().tolist()
    quads = [np.asarray(quad, dtype=np.float64).reshape(4, 2) for quad in corners]
    return {
        f"{tag_name(DICTIONARY)}-{tag}-{corner}": quad[corner]
        for tag, quad in zip(numbers, quads, strict=True)
        for corner in range(4)
    }
