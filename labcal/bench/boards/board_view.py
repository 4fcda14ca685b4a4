"""Random views of a flat board for drawn pictures: tilt, distance, light, noise, blur, and what hides it."""

from dataclasses import dataclass, replace
from typing import Generic, TypeVar

import numpy as np

from labcal.arrays import Mask, Pixels
from labcal.bench.marks.drawn_picture import PAPER, Cover, Exposure, tilted

SIZE = (480, 360)
TILT_DEG = (0.0, 70.0)
BLUR_PX = (0.5, 3.0)
NOISE = (0.008, 0.04)
GRADIENT = (1.0, 10.0)
"""Brightest over darkest light in the picture."""
HIDDEN = 0.3
"""Most of a board's corners that something hides."""
IN_SIGHT = 0.5
"""Share of the corners in sight of a picture that should be indexed."""
OUT_OF_FRAME = 0.35
"""Most offset of the middle of a board from that of the picture, of the picture's sides."""
UNLIKE_PAPER = 0.15
FOCAL = 1.3
"""Focal length over the picture's width."""
CLEAR_PX = 1.0
FRAME_PX = 6.0
"""Distance from the frame of a corner that can be measured."""
LEAST_DEPTH = 0.1
"""Of a corner, in that of the board's middle."""
MOST_TRIES = 200

Board_co = TypeVar("Board_co", covariant=True)


@dataclass(frozen=True)
class BoardPicture(Generic[Board_co]):
    """A picture, and the corners of its board.

    Attributes
    ----------
    picture : ndarray of uint8, shape (h, w)
    board : PrintableTarget
    exposure : Exposure
        How it was taken.
    corner : ndarray, shape (n, 2)
        Images of all corners, in the order of the board's indices, px.
    visible : ndarray of bool, shape (n,)
        True if a corner can be measured: within the frame, nothing over it or the edges that meet there.
    covers : tuple of Cover
        In front of the board.
    """

    picture: np.ndarray
    board: Board_co
    exposure: Exposure
    corner: Pixels
    visible: Mask
    covers: tuple[Cover, ...] = ()

    @property
    def countable(self) -> bool:
        """True if half of the corners are in sight, so that the picture should be indexed."""
        return bool(self.visible.mean() >= IN_SIGHT)


@dataclass(frozen=True)
class Limits:
    """The limits of a view.

    Attributes
    ----------
    narrowest_px : float
        Least height of a square that is seen aslant.
    blur_share : float
        Most blur as a share of that of the narrowest one.
    inside : float
        Least share of the corners in the frame.
    hidden : float
        Most of the corners that something hides; 0 for nothing in front.
    of_all : bool
        True if that is a share of all corners, and not of those in the frame.
    """

    narrowest_px: float
    blur_share: float
    inside: float = IN_SIGHT
    hidden: float = HIDDEN
    of_all: bool = False


@dataclass(frozen=True)
class View:
    """A view with blur, what is in front of the board, and the corners in sight."""

    exposure: Exposure
    covers: tuple[Cover, ...]
    visible: Mask


def axes_at(exposure: Exposure, place: np.ndarray) -> np.ndarray:
    """Return the image of a unit along x and along y at a place of the board (2,), px, in columns."""
    q, H = exposure.seen(place[None])[0], exposure.H
    return np.asarray((H[:2, :2] - q[:, None] * H[2, :2]) / (H[2] @ [*place, 1.0]))


def random_view(
    places: np.ndarray,
    side_px: tuple[float, float],
    random: np.random.Generator,
    out_of_frame: float = OUT_OF_FRAME,
) -> Exposure | None:
    """Return a view of a board at random, not blurred; None where a corner is behind the camera.

    Parameters
    ----------
    places : ndarray, shape (n, 2)
        Of the board's corners; unit: the side of what `side_px` is of.
    side_px : tuple of float
        Range of the root of the area of a square of side 1 in the picture, px.
    random : Generator
    out_of_frame : float
        Most offset of the board's middle, of the picture's sides.
    """
    width = SIZE[0]
    tilt = np.radians(random.uniform(*TILT_DEG))
    side = side_px[0] * (side_px[1] / side_px[0]) ** random.uniform()
    azimuth, roll, direction = random.uniform(-np.pi, np.pi, 3).tolist()
    focal = FOCAL * width
    H = tilted(float(tilt), azimuth, roll, float(focal * np.sqrt(np.cos(tilt)) / side), focal)
    x, y = places.mean(axis=0)
    H = H @ np.array([[1.0, 0.0, -x], [0.0, 1.0, -y], [0.0, 0.0, 1.0]])
    x, y = (np.array(SIZE) * (0.5 + random.uniform(-out_of_frame, out_of_frame, 2))).tolist()
    H = np.array([[1.0, 0.0, x], [0.0, 1.0, y], [0.0, 0.0, 1.0]]) @ H
    if (places @ H[2, :2] + H[2, 2] <= LEAST_DEPTH).any():
        return None
    fall = np.log(GRADIENT[0] * (GRADIENT[1] / GRADIENT[0]) ** random.uniform()) / np.hypot(*SIZE)
    gradient = fall * np.array([np.cos(direction), np.sin(direction)])
    noise = NOISE[0] * (NOISE[1] / NOISE[0]) ** random.uniform()
    return Exposure(SIZE, H, 0.0, gradient, float(noise))


def blurred_view(
    sharp: Exposure, corner: Pixels, axes: np.ndarray, limits: Limits, random: np.random.Generator
) -> View | None:
    """Return a view with a blur at random, and something that hides a part of the board.

    Parameters
    ----------
    sharp : Exposure
    corner : ndarray, shape (n, 2)
        Images of all corners, px.
    axes : ndarray, shape (n, 2, 2)
        Sides of a square at each, px, in columns.
    limits : Limits
    random : Generator

    Returns
    -------
    View or None
        None where too little of the board is in the frame, or squares are too narrow.
    """
    lengths = np.linalg.norm(axes, axis=1).max(axis=1)
    heights = np.abs(np.linalg.det(axes)) / lengths
    last = np.array(SIZE) - 1.0 - FRAME_PX
    inside = np.asarray(((corner > FRAME_PX) & (corner < last)).all(axis=1))
    if not inside.any() or inside.mean() < limits.inside or heights[inside].min() < limits.narrowest_px:
        return None
    most = max(BLUR_PX[0], min(BLUR_PX[1], limits.blur_share * float(heights[inside].min())))
    exposure = replace(sharp, blur_px=float(random.uniform(BLUR_PX[0], most)))
    cover = None
    if limits.hidden:
        counted = len(inside) if limits.of_all else int(inside.sum())
        cover = _random_cover(corner[inside], random.uniform(0.0, limits.hidden) * counted, random)
    visible = inside.copy()
    if cover is not None:
        visible &= cover.distance(corner) > CLEAR_PX + 2.0 * exposure.blur_px + 0.5 * lengths
    return View(exposure, () if cover is None else (cover,), visible)


def _random_cover(inside: Pixels, most: float, random: np.random.Generator) -> Cover | None:
    """Return a rectangle that hides at most so many of the corners in the frame (n, 2), or None."""
    middle = inside[int(random.integers(len(inside)))]
    turn = float(random.uniform(-np.pi, np.pi))
    shape = np.array([1.0, random.uniform(0.4, 2.5)])
    level = random.uniform(0.0, 1.0)
    if abs(level - PAPER) < UNLIKE_PAPER:
        level = PAPER - UNLIKE_PAPER if random.uniform() < PAPER else PAPER + UNLIKE_PAPER
    cover = None
    for size in np.geomspace(4.0, 400.0, 60):
        wider = Cover(middle, size * shape, turn, float(level))
        if (wider.distance(inside) < 0.0).sum() > most:
            break
        cover = wider
    return cover
