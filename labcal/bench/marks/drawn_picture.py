"""Pictures of flat prints drawn from their formula: tilted, blurred, shaded, covered in part, with noise."""

from collections.abc import Callable
from dataclasses import dataclass

import cv2
import numpy as np

FINER, FINEST = 5, 12
"""Samples along a side of a pixel: at least, and at most."""
_SAMPLES_A_BLUR = 6.0
"""A sharp edge in coarser samples is off by 0.01 px, which is more than the noise leaves."""
_BAND = 48
"""Rows of samples that are drawn at once: their arrays stay in the processor's cache."""
SAMPLES = 720
"""Points along an outline."""
PAPER, INK = 0.8, 0.05
"""Levels as shares of full scale, in the brightest light."""
Print = Callable[[np.ndarray, np.ndarray], np.ndarray]
"""Share of ink at places x, y of the print, 0 to 1."""


@dataclass(frozen=True)
class Cover:
    """A rectangle that hides what is behind it, in the picture.

    Attributes
    ----------
    middle : ndarray, shape (2,)
        px.
    half : ndarray, shape (2,)
        Half its sides, px.
    turn : float
        Of its first side, rad.
    level : float
        Grey value as a share of the light.
    """

    middle: np.ndarray
    half: np.ndarray
    turn: float
    level: float

    def distance(self, q: np.ndarray) -> np.ndarray:
        """Return how far pixels (..., 2) are from the rectangle, px; negative inside."""
        along = np.array([[np.cos(self.turn), np.sin(self.turn)], [-np.sin(self.turn), np.cos(self.turn)]])
        out = np.abs((q - self.middle) @ along.T) - self.half
        outside = np.hypot(*np.moveaxis(np.maximum(out, 0.0), -1, 0))
        return np.asarray(outside + np.minimum(out.max(axis=-1), 0.0))


@dataclass(frozen=True)
class Exposure:
    """Camera, light and noise between a print and its picture.

    Attributes
    ----------
    size : tuple of int
        Width and height, px.
    H : ndarray, shape (3, 3)
        From places of the print to pixels.
    blur_px : float
        Standard deviation of the point spread, before the pixel's own width.
    gradient : ndarray, shape (2,)
        Change of the light's logarithm a px.
    noise : float
        Standard deviation at full scale, as a share of it; its square is proportional to the light.
    """

    size: tuple[int, int]
    H: np.ndarray
    blur_px: float
    gradient: np.ndarray
    noise: float

    def seen(self, places: np.ndarray) -> np.ndarray:
        """Return the pixels of places (..., 2) of the print."""
        xyw = np.concatenate([places, np.ones((*places.shape[:-1], 1))], axis=-1) @ self.H.T
        return np.asarray(xyw[..., :2] / xyw[..., 2:])

    def light(self, q: np.ndarray) -> np.ndarray:
        """Return the light at pixels (..., 2), 1 where it is brightest."""
        corners = np.array([[x, y] for x in (0, self.size[0]) for y in (0, self.size[1])])
        return np.asarray(np.exp(q @ self.gradient - (corners @ self.gradient).max()))


def finer(blur_px: float) -> int:
    """Return the samples along a side of a pixel, by the standard deviation of the blur, px."""
    return int(np.clip(np.ceil(_SAMPLES_A_BLUR / blur_px), FINER, FINEST))


def drawn(
    exposure: Exposure, ink: Print, covers: tuple[Cover, ...], random: np.random.Generator
) -> np.ndarray:
    """Return the picture of a print, uint8, shape (height, width).

    Parameters
    ----------
    exposure : Exposure
    ink : callable
        Of the print.
    covers : tuple of Cover
    random : Generator
        Of the noise.
    """
    width, height = exposure.size
    samples = finer(exposure.blur_px)
    border = int(np.ceil(4.0 * exposure.blur_px))
    columns, rows = (
        (np.arange(samples * (n + 2 * border)) + 0.5) / samples - 0.5 - border for n in (width, height)
    )
    level = np.empty((len(rows), len(columns)))
    for first in range(0, len(rows), _BAND):
        band = slice(first, first + _BAND)
        level[band] = _levels(exposure, ink, covers, columns, rows[band])
    fine = cv2.GaussianBlur(level, (0, 0), exposure.blur_px * samples, borderType=cv2.BORDER_REPLICATE)
    inner = fine[
        border * samples : (border + height) * samples, border * samples : (border + width) * samples
    ]
    clean = inner.reshape(height, samples, width, samples).mean(axis=(1, 3))
    noisy = 255.0 * (clean + exposure.noise * np.sqrt(clean) * random.standard_normal(clean.shape))
    return np.asarray(np.clip(np.rint(noisy), 0, 255).astype(np.uint8))


def _levels(
    exposure: Exposure, ink: Print, covers: tuple[Cover, ...], columns: np.ndarray, rows: np.ndarray
) -> np.ndarray:
    """Return what samples at columns and rows (px) of the picture are lit to, sharp and without noise."""
    G = np.linalg.inv(exposure.H)
    x, y, w = (g[0] * columns[None, :] + (g[1] * rows + g[2])[:, None] for g in G)
    scale = np.where(w > 0.0, 1.0 / w, np.nan)  # behind the camera there is nothing
    level = PAPER + (INK - PAPER) * np.nan_to_num(ink(x * scale, y * scale))
    for cover in covers:
        reach = float(np.hypot(*cover.half))
        across = slice(*np.searchsorted(columns, cover.middle[0] + [-reach, reach]))
        down = slice(*np.searchsorted(rows, cover.middle[1] + [-reach, reach]))
        q = np.stack(np.broadcast_arrays(columns[None, across], rows[down, None]), axis=-1)
        level[down, across] = np.where(cover.distance(q) < 0.0, cover.level, level[down, across])
    q = np.stack(np.broadcast_arrays(columns[None, :], rows[:, None]), axis=-1)
    return np.asarray(level * exposure.light(q))


def area_centre(outline: np.ndarray) -> np.ndarray:
    """Return the centre of area of a closed polygon, shape (n, 2), by the shoelace formula."""
    middle = outline.mean(axis=0)
    q = outline - middle
    n = np.roll(q, -1, axis=0)
    cross = q[:, 0] * n[:, 1] - n[:, 0] * q[:, 1]
    return np.asarray(middle + ((q + n) * cross[:, None]).sum(axis=0) / (3.0 * cross.sum()))


def tilted(tilt: float, azimuth: float, roll: float, distance: float, focal_px: float) -> np.ndarray:
    """Return the homography of a tilted print whose origin is in the picture's origin, y up on the print.

    Parameters
    ----------
    tilt, azimuth, roll : float
        Angle of the print's normal to the optical axis, direction of its axis, turn in the picture; rad.
    distance : float
        Of the print's origin along the optical axis, in units of the print.
    focal_px : float
    """
    axis = np.array([np.cos(azimuth), np.sin(azimuth), 0.0])
    R = (
        cv2.Rodrigues(tilt * axis)[0]
        @ cv2.Rodrigues(np.array([0.0, 0.0, roll]))[0]
        @ np.diag([1.0, -1.0, -1.0])
    )
    K = np.diag([focal_px, focal_px, 1.0])
    return np.asarray(K @ np.stack([R[:, 0], R[:, 1], np.array([0.0, 0.0, distance])], axis=-1) / distance)
