"""Drawn pictures of coded dots over all difficulties of their detection, with the truth of every mark."""

from dataclasses import dataclass

import numpy as np

from labcal.arrays import Mask, PixelCovariances, Pixels
from labcal.bench.detect.bound import outline_shapes
from labcal.bench.marks.drawn_picture import PAPER, SAMPLES, Cover, Exposure, area_centre, drawn, tilted
from labcal.rng import generator
from labcal.targets.coded_dots import QUIET, RING_INNER, RING_OUTER
from labcal.targets.ring_codes import RingCode, code_book

SIZE = (400, 300)
RADIUS_PX = (5.0, 40.0)
"""Root of the product of a dot's semi-axes."""
TILT_DEG = (0.0, 60.0)
BLUR_PX, MOST_BLUR_SHARE, MOST_BLUR_PX = 0.35, 0.35, 3.0
"""Least, and greatest as a share of the minor semi-axis."""
NOISE = (0.008, 0.05)
GRADIENT = (1.0, 10.0)
"""Brightest over darkest light in the picture."""
COVERED = 0.5
"""Share of the marks that something is laid over."""
HIDDEN = 0.3
"""Most of a ring that may be hidden of a mark that should be read."""
UNLIKE_PAPER = 0.15
"""Covers differ by so much from paper, as a share of full scale: nobody could tell others from it."""
PITCH = 2.0 * QUIET + 0.5
"""In radii of a dot."""
FOCAL = 1.3
"""Focal length over the picture's width."""
CLEAR_PX = 1.0
"""A dot that should be measured is this far from covers, and two standard deviations of the blur."""


@dataclass(frozen=True)
class CodedPicture:
    """A picture, and its marks.

    Attributes
    ----------
    picture : ndarray of uint8, shape (h, w)
        As the camera gives it.
    exposure : Exposure
        How it was taken.
    point : tuple of str, length n
        Names of the marks.
    centroid : ndarray, shape (n, 2)
        Centre of area of the image of each dot, px.
    shape : ndarray, shape (n, 2, 2)
        Matrix S of its outline, px squared.
    measurable : ndarray of bool, shape (n,)
        Whether the whole dot can be seen, and of its ring all but 30%.
    hidden : ndarray, shape (n,)
        Share of the ring that is hidden, 0 to 1.
    """

    picture: np.ndarray
    exposure: Exposure
    point: tuple[str, ...]
    centroid: Pixels
    shape: PixelCovariances
    measurable: Mask
    hidden: np.ndarray


def coded_picture(code: RingCode, number: int, seed: int) -> CodedPicture:
    """Draw one picture; each quantity is drawn from its range.

    Parameters
    ----------
    code : RingCode
    number : int
        Of the picture.
    seed : int
    """
    random = generator(seed, "bench marks", str(code), f"picture {number}")
    exposure, minor = _exposure(random)
    reach = int(np.ceil(np.hypot(*SIZE) / (2.0 * minor * PITCH))) + 1
    sheet = _Sheet(code, reach, random)
    angle = 2.0 * np.pi * np.arange(SAMPLES) / SAMPLES
    circle = np.stack([np.cos(angle), np.sin(angle)], axis=-1)
    inside = _in_frame(exposure.seen(sheet.places))
    places = sheet.places[inside][:, None]
    outlines = exposure.seen(places + circle)
    rings = exposure.seen(places + 0.5 * (RING_INNER + RING_OUTER) * circle)
    names = tuple(f"{code}-{mark}" for mark in sheet.marks[inside].tolist())
    covers = tuple(_cover(outlines[k], random) for k in range(len(outlines)) if random.uniform() < COVERED)
    shape = outline_shapes(outlines)
    hidden = np.zeros(len(outlines))
    measurable = np.asarray(_in_frame(exposure.seen(places + RING_OUTER * circle)).all(axis=1))
    measurable &= np.sqrt(np.sqrt(np.linalg.det(shape))) >= RADIUS_PX[0]
    measurable &= exposure.blur_px <= MOST_BLUR_SHARE * np.sqrt(np.linalg.eigvalsh(shape)[:, 0])
    measurable &= np.array([names.count(name) == 1 for name in names], dtype=bool)
    if covers:
        hidden = (_nearest(covers, rings) < 0.0).mean(axis=-1)
        near = _nearest(covers, outlines).min(axis=-1)
        measurable &= (near > CLEAR_PX + 2.0 * exposure.blur_px) & (hidden <= HIDDEN)
        measurable &= _nearest(covers, outlines.mean(axis=1)) > 0.0
    return CodedPicture(
        picture=drawn(exposure, sheet.ink, covers, random),
        exposure=exposure,
        point=names,
        centroid=np.array([area_centre(outline) for outline in outlines]).reshape(-1, 2),
        shape=shape,
        measurable=measurable,
        hidden=hidden,
    )


def _exposure(random: np.random.Generator) -> tuple[Exposure, float]:
    """Return how a picture is taken, and the minor semi-axis of the dot in its middle, px."""
    width, height = SIZE
    tilt = np.radians(random.uniform(*TILT_DEG))
    radius = RADIUS_PX[0] * (RADIUS_PX[1] / RADIUS_PX[0]) ** random.uniform()
    minor = float(radius * np.sqrt(np.cos(tilt)))
    blur = random.uniform(BLUR_PX, max(BLUR_PX, min(MOST_BLUR_SHARE * minor, MOST_BLUR_PX)))
    azimuth, roll, direction = random.uniform(-np.pi, np.pi, 3).tolist()
    focal = FOCAL * width
    H = tilted(float(tilt), azimuth, roll, float(focal * np.sqrt(np.cos(tilt)) / radius), focal)
    x, y = (np.array([width, height]) / 2.0 + random.uniform(-0.5, 0.5, 2)).tolist()
    H = np.array([[1.0, 0.0, x], [0.0, 1.0, y], [0.0, 0.0, 1.0]]) @ H
    fall = np.log(GRADIENT[0] * (GRADIENT[1] / GRADIENT[0]) ** random.uniform()) / np.hypot(*SIZE)
    gradient = fall * np.array([np.cos(direction), np.sin(direction)])
    noise = NOISE[0] * (NOISE[1] / NOISE[0]) ** random.uniform()
    return Exposure(SIZE, H, float(blur), gradient, float(noise)), minor


class _Sheet:
    """A sheet of marks at the nodes of a grid, each turned as chance has it, in radii of a dot."""

    def __init__(self, code: RingCode, reach: int, random: np.random.Generator) -> None:
        self._reach = reach
        nodes = np.stack(np.meshgrid(*[np.arange(-reach, reach + 1)] * 2), axis=-1).reshape(-1, 2)
        self.places = nodes * PITCH
        self.marks = np.resize(random.permutation(code.size)[: len(nodes)], len(nodes))
        self._turns = random.uniform(0.0, code.sectors, len(nodes))
        book = code_book(code)
        self._words = book.words[book.first[self.marks]]

    def ink(self, x: np.ndarray, y: np.ndarray) -> np.ndarray:
        """Return 1 on the print of marks, else 0."""
        with np.errstate(invalid="ignore"):  # NaN is behind the camera
            col, row = (np.rint(place / PITCH).astype(int) for place in (x, y))
        reach, sectors = self._reach, self._words.shape[1]
        known = (np.abs(col) <= reach) & (np.abs(row) <= reach)
        node = np.where(known, (row + reach) * (2 * reach + 1) + col + reach, 0)
        u, v = x - col * PITCH, y - row * PITCH
        rho = np.hypot(u, v)
        turn = self._turns[node] - np.nan_to_num(np.arctan2(v, u)) / (2.0 * np.pi) * sectors
        black = self._words[node, np.floor(turn).astype(int) % sectors]
        ring = (rho > RING_INNER) & (rho < RING_OUTER) & black
        return np.where(known & ((rho < 1.0) | ring), 1.0, 0.0)


def _nearest(covers: tuple[Cover, ...], q: np.ndarray) -> np.ndarray:
    """Return how far pixels (..., 2) are from the nearest cover, px; negative behind one."""
    return np.asarray(np.min([cover.distance(q) for cover in covers], axis=0))


def _in_frame(q: np.ndarray) -> np.ndarray:
    """Tell which pixels (..., 2) lie in the picture."""
    return np.asarray(((q > 0.0) & (q < np.array(SIZE) - 1.0)).all(axis=-1))


def _cover(outline: np.ndarray, random: np.random.Generator) -> Cover:
    """Return a rectangle that is laid over a mark: over its rim, over half of it, or across it."""
    centre = outline.mean(axis=0)
    radius = float(np.sqrt(np.sqrt(np.linalg.det(outline_shapes(outline[None])[0]))))
    turn = random.uniform(-np.pi, np.pi)
    half = radius * np.array([random.uniform(0.3, 2.0), random.uniform(1.0, 6.0)])
    edge = radius * random.uniform(0.0, RING_OUTER)
    out = np.array([np.cos(turn), np.sin(turn)])
    level = random.uniform(0.0, 1.0)
    if abs(level - PAPER) < UNLIKE_PAPER:
        level = PAPER - UNLIKE_PAPER if random.uniform() < PAPER else PAPER + UNLIKE_PAPER
    return Cover(centre + (edge + half[0]) * out, half, float(turn), float(level))
