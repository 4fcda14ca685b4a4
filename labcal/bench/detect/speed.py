"""Duration of detection compared with the fastest mode of ``cv2.findCirclesGrid``, and on a large picture."""

import time
from collections.abc import Callable

import cv2
import numpy as np

from labcal.bench.detect.opencv_grid import MODES, blob_detector
from labcal.bench.groups import Bench, Findings
from labcal.bench.held_board import tilted_pose
from labcal.cameras.camera import Camera
from labcal.cameras.dot_image import dot_images
from labcal.cameras.lens import LENGTH
from labcal.detect.detector import detect_dots
from labcal.report.bench import Figure, at_most
from labcal.rng import generator
from labcal.targets.grid import DotGrid, Rings

SIZE, LARGE = (1280, 960), (5472, 3648)
"""1.2 and 20 megapixels."""
ROUNDS, QUICK_ROUNDS, LARGE_ROUNDS = 15, 5, 3
RATIO_LIMIT, LARGE_LIMIT_S = 1.0, 2.0
TILT_DEG, FOCAL_OVER_WIDTH, NOISE, BLUR_PX = 20.0, 1.2, 2.5, 0.8
FINE_BITS = 6
RING_HOLE_MM = 2.0
TARGET = DotGrid(
    name="speed",
    cols=14,
    rows=11,
    pitch_x_mm=10.0,
    pitch_y_mm=10.0,
    dot_diameter_mm=5.0,
    ring_outer_diameter_mm=5.0,
    ring_inner_diameter_mm=RING_HOLE_MM,
    rings=Rings(origin=(2, 2), x=(11, 2), y=(2, 7)),
    margin_mm=10.0,
)


def speed_findings(bench: Bench) -> Findings:
    """Return the ratio of the times on one picture, taken in turn, and the time for 20 megapixels.

    OpenCV gets every chance: its default blob parameters and tuned ones, both of its ways to search, and
    the picture with plain dots where it refuses rings. The fastest that finds the grid counts.
    """
    rounds = QUICK_ROUNDS if bench.quick else ROUNDS
    bench.progress.start("speed", 3)
    random = generator(bench.seed, "bench detect", "speed")
    picture, plain = drawn_board(SIZE, random), drawn_board(SIZE, random, hole=0.0)
    fastest = _fastest_of_opencv((picture, plain))
    bench.progress.advance()
    ours, theirs = [], []
    for _ in range(rounds):
        ours.append(_seconds(lambda: detect_dots(picture, TARGET)))
        theirs.append(float("nan") if fastest is None else _seconds(fastest))
    found = detect_dots(picture, TARGET)
    bench.progress.advance()
    large = drawn_board(LARGE, random)
    large_s = float(np.median([_seconds(lambda: detect_dots(large, TARGET)) for _ in range(LARGE_ROUNDS)]))
    whole = detect_dots(large, TARGET)
    bench.progress.advance()
    ratio = float(np.median(np.array(ours) / np.array(theirs)))
    return Findings(
        [
            at_most("speed, 1.2 megapixels and 154 dots: dots missed", TARGET.count - int(found.ok.sum()), 0),
            at_most("speed, the same: time over that of cv2.findCirclesGrid", ratio, RATIO_LIMIT),
            at_most("speed, 20 megapixels: dots missed", TARGET.count - int(whole.ok.sum()), 0),
            at_most("speed, 20 megapixels: time, s", large_s, LARGE_LIMIT_S),
        ],
        [
            Figure(name="speed, 1.2 megapixels and 154 dots: labcal, s", value=float(np.median(ours))),
            Figure(name="speed, the same: cv2.findCirclesGrid, s", value=float(np.median(theirs))),
        ],
    )


def drawn_board(size: tuple[int, int], random: np.random.Generator, hole: float = 1.0) -> np.ndarray:
    """Draw the target on white paper before a grey room, with blur and noise, uint8.

    Parameters
    ----------
    size : (int, int)
        Width and height, px.
    random : numpy.random.Generator
        Of the noise.
    hole : float
        Of the rings, as a multiple of the declared one; 0: dots without rings.
    """
    width, height = size
    focal_px = FOCAL_OVER_WIDTH * width
    K = np.array([[focal_px, 0.0, 0.5 * (width - 1)], [0.0, focal_px, 0.5 * (height - 1)], [0.0, 0.0, 1.0]])
    camera = Camera(K, "pinhole", np.zeros(LENGTH), np.diag([1.0, -1.0, -1.0, 1.0]), size)
    x_min, y_min, x_max, y_max = TARGET.extent_mm
    away = 1.3 * FOCAL_OVER_WIDTH * (x_max - x_min)
    T_world_target = tilted_pose(TARGET, TILT_DEG, 0.6, 0.1, np.array([0.0, 0.0, -away]))
    picture = np.full((height, width), 100, dtype=np.uint8)
    corners = np.array([[x_min, y_min, 0.0], [x_max, y_min, 0.0], [x_max, y_max, 0.0], [x_min, y_max, 0.0]])
    turned = corners @ T_world_target[:3, :3].T + T_world_target[:3, 3]
    _fill(picture, camera.project(turned).q, 210)
    radii = 0.5 * TARGET.outer_diameters_mm()
    for outline in dot_images(camera, T_world_target, TARGET.points(), radii).outline:
        _fill(picture, outline, 40)
    if hole > 0.0:
        rings = TARGET.points(np.array(TARGET.ring_indices))
        inner = np.full(len(rings), 0.5 * hole * RING_HOLE_MM)
        for outline in dot_images(camera, T_world_target, rings, inner).outline:
            _fill(picture, outline, 210)
    blurred = cv2.GaussianBlur(picture.astype(np.float32), (0, 0), BLUR_PX)
    noisy = blurred + NOISE * random.standard_normal(blurred.shape, dtype=np.float32)
    clipped: np.ndarray = np.clip(np.rint(noisy), 0, 255).astype(np.uint8)
    return clipped


def _fill(picture: np.ndarray, outline: np.ndarray, grey: int) -> None:
    """Fill an outline (n, 2), px."""
    corners = np.rint(outline * 2**FINE_BITS).astype(np.int32)
    cv2.fillPoly(picture, [corners], grey, cv2.LINE_AA, FINE_BITS)


def _fastest_of_opencv(pictures: tuple[np.ndarray, ...]) -> Callable[[], object] | None:
    """Return the fastest call of OpenCV that finds the grid; none if there is none."""
    shape = (TARGET.cols, TARGET.rows)
    detectors = (cv2.SimpleBlobDetector.create(), blob_detector(5.0, 40.0))
    best, least = None, float("inf")
    for picture in pictures:
        for detector in detectors:
            for flags in MODES.values():

                def call(
                    picture: np.ndarray = picture,
                    flags: int = flags,
                    detector: cv2.SimpleBlobDetector = detector,
                ) -> object:
                    return cv2.findCirclesGrid(picture, shape, flags=flags, blobDetector=detector)[0]

                if call() and (seconds := min(_seconds(call) for _ in range(3))) < least:
                    best, least = call, seconds
    return best


def _seconds(call: Callable[[], object]) -> float:
    """Return the duration of a call."""
    began = time.perf_counter()
    call()
    return time.perf_counter() - began
