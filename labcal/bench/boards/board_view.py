"""Random views of a flat board for drawn pictures: tilt, distance, light, noise, and what hides a part."""

import numpy as np

from labcal.arrays import Pixels
from labcal.bench.boards.chessboard_picture import (
    FOCAL,
    GRADIENT,
    HIDDEN,
    LEAST_DEPTH,
    NOISE,
    OUT_OF_FRAME,
    SIZE,
    TILT_DEG,
    UNLIKE_PAPER,
)
from labcal.bench.marks.drawn_picture import PAPER, Cover, Exposure, tilted


def random_view(
    places: np.ndarray, side_px: tuple[float, float], random: np.random.Generator
) -> Exposure | None:
    """Return a view of a board at random, not blurred; None where a corner is behind the camera.

    Parameters
    ----------
    places : ndarray, shape (n, 2)
        Of the board's corners; unit: the side of what `side_px` is of.
    side_px : tuple of float
        Range of the root of the area of a square of side 1 in the picture, px.
    random : Generator
    """
    width = SIZE[0]
    tilt = np.radians(random.uniform(*TILT_DEG))
    side = side_px[0] * (side_px[1] / side_px[0]) ** random.uniform()
    azimuth, roll, direction = random.uniform(-np.pi, np.pi, 3).tolist()
    focal = FOCAL * width
    H = tilted(float(tilt), azimuth, roll, float(focal * np.sqrt(np.cos(tilt)) / side), focal)
    x, y = places.mean(axis=0)
    H = H @ np.array([[1.0, 0.0, -x], [0.0, 1.0, -y], [0.0, 0.0, 1.0]])
    x, y = (np.array(SIZE) * (0.5 + random.uniform(-OUT_OF_FRAME, OUT_OF_FRAME, 2))).tolist()
    H = np.array([[1.0, 0.0, x], [0.0, 1.0, y], [0.0, 0.0, 1.0]]) @ H
    if (places @ H[2, :2] + H[2, 2] <= LEAST_DEPTH).any():
        return None
    fall = np.log(GRADIENT[0] * (GRADIENT[1] / GRADIENT[0]) ** random.uniform()) / np.hypot(*SIZE)
    gradient = fall * np.array([np.cos(direction), np.sin(direction)])
    noise = NOISE[0] * (NOISE[1] / NOISE[0]) ** random.uniform()
    return Exposure(SIZE, H, 0.0, gradient, float(noise))


def random_cover(inside: Pixels, random: np.random.Generator) -> Cover | None:
    """Return a rectangle that hides up to 30% of the corners in the frame (n, 2), or None."""
    wanted = random.uniform(0.0, HIDDEN)
    middle = inside[int(random.integers(len(inside)))]
    turn = float(random.uniform(-np.pi, np.pi))
    shape = np.array([1.0, random.uniform(0.4, 2.5)])
    level = random.uniform(0.0, 1.0)
    if abs(level - PAPER) < UNLIKE_PAPER:
        level = PAPER - UNLIKE_PAPER if random.uniform() < PAPER else PAPER + UNLIKE_PAPER
    cover = None
    for size in np.geomspace(4.0, 400.0, 60):
        wider = Cover(middle, size * shape, turn, float(level))
        if (wider.distance(inside) < 0.0).sum() > wanted * len(inside):
            break
        cover = wider
    return cover
