"""Duration of detection compared with the fastest mode of ``cv2.findCirclesGrid``, and on a large picture."""

import cv2
import numpy as np

from labcal.bench.detect.opencv_grid import MODES, blob_detector
from labcal.bench.detect.speed_boards import board_findings
from labcal.bench.detect.timing import Call, Times, times_in_turn
from labcal.bench.groups import Bench, Findings
from labcal.bench.held_board import tilted_pose
from labcal.cameras.camera import Camera
from labcal.cameras.dot_image import dot_images
from labcal.cameras.lens import LENGTH
from labcal.detect.detector import detect_dots
from labcal.detect.dots import PictureDots
from labcal.report.bench import Figure, at_most
from labcal.rng import generator
from labcal.run.threads import one_opencv_thread
from labcal.targets.grid import DotGrid, Rings

SIZE, LARGE = (1280, 960), (5472, 3648)
"""1.2 and 20 megapixels."""
ROUNDS, QUICK_ROUNDS, LARGE_ROUNDS = 15, 5, 3
RATIO_LIMIT, LARGE_LIMIT_S = 0.5, 2.0
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
    """Return the ratios of the times on the same pictures, taken in turn, and the time for 20 megapixels.

    OpenCV gets every chance: its default blob parameters and tuned ones, both of its ways to search, and
    the picture with plain dots where it refuses rings. The fastest that finds the grid counts.
    """
    rounds = QUICK_ROUNDS if bench.quick else ROUNDS
    bench.progress.start("speed", 3)
    random = generator(bench.seed, "bench detect", "speed")
    picture, plain = drawn_board(SIZE, random), drawn_board(SIZE, random, hole=0.0)

    def own() -> PictureDots:
        return detect_dots(picture, TARGET)

    found = own()
    with one_opencv_thread():
        fastest = fastest_of_opencv((picture, plain))
        ours, theirs = times_in_turn((own, fastest), rounds)
    _, in_threads = times_in_turn((own, fastest), rounds)
    bench.progress.advance()
    large = drawn_board(LARGE, random)
    whole = detect_dots(large, TARGET)
    (large_times,) = times_in_turn((lambda: detect_dots(large, TARGET),), LARGE_ROUNDS)
    bench.progress.advance()
    boards = board_findings(rounds, random)
    bench.progress.advance()
    return Findings(
        [
            at_most("speed, 1.2 megapixels and 154 dots: dots missed", TARGET.count - int(found.ok.sum()), 0),
            at_most(
                "speed, the same: processor time over that of cv2.findCirclesGrid",
                ours.over(theirs),
                RATIO_LIMIT,
            ),
            at_most("speed, 20 megapixels: dots missed", TARGET.count - int(whole.ok.sum()), 0),
            at_most("speed, 20 megapixels: time, s", float(np.median(large_times.wall)), LARGE_LIMIT_S),
            *boards.checks,
        ],
        [
            *_both("speed, 1.2 megapixels and 154 dots: labcal", ours),
            *_both("speed, the same: cv2.findCirclesGrid in one thread", theirs),
            *_both("speed, the same: cv2.findCirclesGrid in its own number of threads", in_threads),
            *_both("speed, 20 megapixels: labcal", large_times),
            *boards.references,
        ],
    )


def _both(name: str, times: Times) -> list[Figure]:
    """Return the least processor time and the least time of the clock."""
    return [
        Figure(name=f"{name}, processor time, s", value=float(times.cpu.min())),
        Figure(name=f"{name}, s", value=float(times.wall.min())),
    ]


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


def fastest_of_opencv(pictures: tuple[np.ndarray, ...]) -> Call:
    """Return the fastest call of OpenCV that finds the grid.

    Raises
    ------
    RuntimeError
        None does: the picture is not what it should be.
    """
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

                if call() and (seconds := float(times_in_turn((call,), 3)[0].cpu.min())) < least:
                    best, least = call, seconds
    if best is None:
        raise RuntimeError("cv2.findCirclesGrid finds the drawn grid in none of its modes")
    return best
