"""The Cramer-Rao bound of the centre of a dot, the least covariance of any unbiased method.

The picture of a dot is modelled here on its own, without the detector: an ellipse drawn at several times the
resolution, blurred by a Gauss function and averaged over each pixel. What is not known to a detector is not
known to the bound either: centre, the ellipse's three parameters, blur, both levels and the slope of the
light are all unknown. The noise of every pixel is independent, with a known standard deviation.
"""

from dataclasses import dataclass

import cv2
import numpy as np

from labcal.arrays import Outlines

FINER = 5
"""Drawn at so many times the resolution."""
STEP = 0.02
"""Of the numerical derivatives, px."""
_REACH_SIGMAS = 4.0


@dataclass(frozen=True)
class ImagedDot:
    """The parameters of the image of a dot."""

    centre: np.ndarray
    """(2,), px."""
    shape: np.ndarray
    """(2, 2), S of the outline ``(q - c)' inv(S) (q - c) = 1``, px squared."""
    blur_px: float
    """Standard deviation of the point spread, before the pixel's own width."""
    dark: float
    light: float
    """Levels of dot and board, in the unit of the noise."""
    reach: float
    """Pixels count up to this multiple of the outline; there the next dot begins to matter."""


def outline_shapes(outlines: Outlines) -> np.ndarray:
    """Return the matrix S of outlines that are nearly ellipses, sampled at equal steps of their angle.

    Parameters
    ----------
    outlines : ndarray, shape (n, samples, 2)
        px.

    Returns
    -------
    ndarray, shape (n, 2, 2)
        px squared.
    """
    away = outlines - outlines.mean(axis=1, keepdims=True)
    return np.asarray(2.0 * np.einsum("nki,nkj->nij", away, away) / outlines.shape[1])


def centre_bound(dot: ImagedDot, noise: float) -> np.ndarray:
    """Return the least covariance of an unbiased measurement of a dot's centre, px squared, shape (2, 2).

    Parameters
    ----------
    dot : ImagedDot
    noise : float
        Standard deviation of every pixel, in the unit of the levels.
    """
    return np.asarray(centre_bounds(dot, np.array([[noise, noise]]))[0])


def centre_bounds(dot: ImagedDot, noises: np.ndarray) -> np.ndarray:
    """Return the least covariances of a dot's centre under several noises, px squared, shape (k, 2, 2).

    Parameters
    ----------
    dot : ImagedDot
    noises : ndarray, shape (k, 2)
        Standard deviations of pixels of the dot and of the board, in the unit of the levels. Between the two
        the variance grows in a line with the light, as that of photons does.

    Notes
    -----
    The inverse of the Fisher information of ten parameters (Kay 1993, section 3.9), its block of the centre.
    What the variance itself tells of the edge is not counted.
    """
    derivatives, covered, inside = _derivatives(dot)
    D, share = derivatives[:, inside], covered[inside]
    return place_bounds(D, share, noises)


def place_bounds(D: np.ndarray, share: np.ndarray, noises: np.ndarray) -> np.ndarray:
    """Return the least covariances of the first two parameters of a picture, px squared, shape (k, 2, 2).

    Parameters
    ----------
    D : ndarray, shape (p, n)
        Derivatives of the pixels by the parameters.
    share : ndarray, shape (n,)
        Shares of the pixels that are dark.
    noises : ndarray, shape (k, 2)
        Standard deviations of dark and of light pixels.
    """
    bounds = []
    for dark, light in noises.tolist():
        J = D / np.sqrt(share * dark**2 + (1.0 - share) * light**2)
        scale = np.linalg.norm(J, axis=1)  # so that the inverse does not care for units
        scaled = J / scale[:, None]
        bounds.append((np.linalg.inv(scaled @ scaled.T) / np.outer(scale, scale))[:2, :2])
    return np.array(bounds)


def _derivatives(dot: ImagedDot) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Return derivatives by every parameter, (10, h, w), shares of the dot, and a mask of used pixels."""
    extent = np.sqrt(np.diag(dot.shape)) * dot.reach + 1.0
    low = np.floor(dot.centre - extent).astype(int)
    size = np.ceil(dot.centre + extent).astype(int) - low + 1
    centre = dot.centre - low
    s_xx, s_xy, s_yy = dot.shape[0, 0], dot.shape[0, 1], dot.shape[1, 1]
    at = np.array([centre[0], centre[1], s_xx, s_xy, s_yy, dot.blur_px])
    # A step along S moves the outline by about step / (2 semi-axis).
    steps = STEP * np.array([1.0, 1.0, *(2.0 * np.sqrt([s_xx, np.sqrt(s_xx * s_yy), s_yy])), 1.0])
    width, height = size.tolist()
    fall = dot.dark - dot.light
    shaped = []
    for axis, step in enumerate(steps):
        by = np.zeros(6)
        by[axis] = step
        up, down = _coverage(at + by, (width, height)), _coverage(at - by, (width, height))
        shaped.append(fall * (up - down) / (2.0 * step))
    covered = _coverage(at, (width, height))
    level = (dot.light + fall * covered) / dot.light
    y, x = np.mgrid[:height, :width]
    away = np.stack([x - centre[0], y - centre[1]])
    lights = [1.0 - covered, covered, level * away[0], level * away[1]]
    inside = _ellipse_radius(away, dot.shape) <= dot.reach
    return np.stack([*shaped, *lights]), covered, inside


def _ellipse_radius(away: np.ndarray, shape: np.ndarray) -> np.ndarray:
    """Return 1 on the ellipse, 0 in its middle; `away` is (2, h, w)."""
    solved = np.einsum("ij,jhw->ihw", np.linalg.inv(shape), away)
    return np.asarray(np.sqrt((away * solved).sum(axis=0)))


def _coverage(parameters: np.ndarray, size: tuple[int, int]) -> np.ndarray:
    """Return the share of every pixel that a blurred ellipse covers, shape (height, width).

    Parameters
    ----------
    parameters : ndarray, shape (6,)
        Centre, the entries xx, xy and yy of S, blur.
    size : (int, int)
        Width and height, px.
    """
    x, y, s_xx, s_xy, s_yy, blur = parameters.tolist()
    width, height = size
    border = int(np.ceil(_REACH_SIGMAS * blur))
    rows, columns = (
        (np.arange(FINER * (n + 2 * border)) + 0.5) / FINER - 0.5 - border for n in (height, width)
    )
    away = np.stack(np.broadcast_arrays(columns[None, :] - x, rows[:, None] - y))
    S = np.array([[s_xx, s_xy], [s_xy, s_yy]])
    solved = np.einsum("ij,jhw->ihw", np.linalg.inv(S), away)
    radius = np.sqrt((away * solved).sum(axis=0))
    # To first order (radius - 1) over its own gradient is the distance from the outline.
    steepness = np.linalg.norm(solved, axis=0) / np.maximum(radius, 1e-9)
    distance = (radius - 1.0) / np.maximum(steepness, 1e-9)
    fine = np.clip(0.5 - FINER * distance, 0.0, 1.0)
    kernel = 2 * border * FINER + 1
    fine = cv2.GaussianBlur(fine, (kernel, kernel), blur * FINER, borderType=cv2.BORDER_REPLICATE)
    inner = fine[border * FINER : (border + height) * FINER, border * FINER : (border + width) * FINER]
    return np.asarray(inner.reshape(height, FINER, width, FINER).mean(axis=(1, 3)))
