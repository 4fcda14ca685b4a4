"""Ellipses through the edge points of spots, found along rays, and how bright the spots' middles are."""

from dataclasses import dataclass

import cv2
import numpy as np
from jaxtyping import Float64

from labcal.arrays import PixelCovariances, Pixels
from labcal.detect.blobs import Blobs
from labcal.detect.grey import GreyPicture
from labcal.targets.grid import DotGrid

_RAYS = 24
_STEPS = 48  # samples along a ray
_BATCH = 4096  # spots sampled at once, to bound the memory
_MIN_RAYS = 18  # with an edge that fits the ellipse
_FIRST_EDGE = 0.5  # of the radius: the edge is looked for from here outward
_LONGEST_RAY = 1.5  # of the radius
_MIN_MINOR = 1.5  # px


@dataclass(frozen=True)
class Outlines:
    """Spots with a clean elliptic edge.

    Attributes
    ----------
    centre : ndarray, shape (n, 2)
        px, good to a tenth or so.
    shape : ndarray, shape (n, 2, 2)
        Outline matrices, see `PictureDots.outline`.
    hole : ndarray, shape (n,)
        Brightness of the middle: 0 as dark as the dot, 1 as bright as the board.
    """

    centre: Pixels
    shape: PixelCovariances
    hole: Float64[np.ndarray, " n"]

    @property
    def radius(self) -> Float64[np.ndarray, " n"]:
        """Geometric mean of the semi-axes, px."""
        radius: np.ndarray = np.sqrt(np.sqrt(np.linalg.det(self.shape)))
        return radius

    def select(self, which: np.ndarray) -> "Outlines":
        """Return some of the spots, by mask or by index."""
        return Outlines(self.centre[which], self.shape[which], self.hole[which])


def clear_reach(target: DotGrid) -> float:
    """Return how far from a dot's centre, in radii, nothing but board surrounds it."""
    radius = target.largest_diameter_mm / 2
    gap = min(target.cell_mm) / radius - 2
    return 1 + 0.7 * gap


def trace_outlines(grey: GreyPicture, blobs: Blobs, target: DotGrid) -> Outlines:
    """Return the spots that have an elliptic edge in the full picture, each once.

    Along rays from each rough centre the edge is where the grey value is half-way between dot and board; an
    ellipse is fitted to these points and the rays are cast once more from it.
    """
    whole = ~blobs.cut
    spots = Outlines(blobs.centre[whole], blobs.shape[whole], np.zeros(int(whole.sum())))
    # Spots that are found in several levels are taken from the finest first; most duplicates go here,
    # cheaply.
    spots = spots.select(_distinct(spots, 0.1))
    for _ in range(2):
        parts = [
            _trace(grey, spots.select(np.arange(first, min(first + _BATCH, len(spots.centre)))), target)
            for first in range(0, len(spots.centre), _BATCH)
        ]
        if parts:
            spots = Outlines(
                np.concatenate([part.centre for part in parts]),
                np.concatenate([part.shape for part in parts]),
                np.concatenate([part.hole for part in parts]),
            )
    return spots.select(_distinct(spots, 0.4))


def _distinct(spots: Outlines, closeness: float) -> np.ndarray:
    """Return the indices of the first of every group of spots of nearly one centre and size."""
    kept: list[int] = []
    cells: dict[tuple[int, int], list[int]] = {}
    radius = spots.radius
    if len(radius) == 0:
        return np.zeros(0, dtype=int)
    cell = max(float(np.median(radius)), 1.0)
    for i, (x, y) in enumerate(spots.centre):
        reach = int(np.ceil(closeness * radius[i] / cell))
        home = (int(x // cell), int(y // cell))
        near = [
            j
            for dx in range(-reach, reach + 1)
            for dy in range(-reach, reach + 1)
            for j in cells.get((home[0] + dx, home[1] + dy), ())
        ]
        same = any(
            np.hypot(x - spots.centre[j, 0], y - spots.centre[j, 1]) < closeness * radius[i]
            and abs(np.log(radius[i] / radius[j])) < closeness
            for j in near
        )
        if not same:
            kept.append(i)
            cells.setdefault(home, []).append(i)
    return np.array(kept, dtype=int)


def _trace(grey: GreyPicture, spots: Outlines, target: DotGrid) -> Outlines:
    """Cast rays, fit ellipses, and return those spots whose edge is one."""
    reach = min(_LONGEST_RAY, clear_reach(target))
    root = matrix_root(spots.shape)
    angles = np.arange(_RAYS) * 2 * np.pi / _RAYS
    directions = np.stack([np.cos(angles), np.sin(angles)], axis=-1)
    rho = np.linspace(0, reach, _STEPS + 1)
    rays = np.einsum("nij,kj->nki", root, directions)
    samples = spots.centre[:, None, None] + rho[:, None] * rays[:, :, None]
    flat = samples.astype(np.float32).reshape(len(samples), -1, 2)
    profile = cv2.remap(grey, flat[..., 0], flat[..., 1], cv2.INTER_LINEAR, borderMode=cv2.BORDER_REPLICATE)
    profile = profile.reshape(len(samples), _RAYS, _STEPS + 1)

    inside = np.median(profile[:, :, (rho > 0.6) & (rho < 0.75)], axis=(1, 2))  # noqa: PLR2004 - off hole and edge
    outside = np.median(profile[:, :, rho > 1 + 0.6 * (reach - 1)], axis=2)
    around = np.median(np.stack([np.roll(outside, k, axis=1) for k in (-2, -1, 0, 1, 2)]), axis=0)
    edge, found = _half_crossings(profile, (inside[:, None] + around) / 2, rho)
    centre, inverse, rough = _ellipses(edge[..., None] * directions, found)
    minor = np.linalg.eigvalsh(root)[:, 0]
    fits = (minor > _MIN_MINOR) & (rough < 0.03 + 0.15 / minor)

    hole_radius = target.hole_share
    body = (hole_radius + 1) / 2
    middle = profile[:, :, rho < 0.5 * hole_radius].mean(axis=(1, 2))
    dark = profile[:, :, np.abs(rho - body) < 0.1].mean(axis=(1, 2))  # noqa: PLR2004 - of the radius
    step = around.mean(axis=1) - dark
    fits &= step > 0
    back = root[fits]
    shape = back @ np.linalg.inv(inverse[fits]) @ back
    return Outlines(
        spots.centre[fits] + np.einsum("nij,nj->ni", back, centre[fits]),
        (shape + np.swapaxes(shape, 1, 2)) / 2,
        ((middle[fits] - dark[fits]) / step[fits]).astype(np.float64),
    )


def _half_crossings(profile: np.ndarray, half: np.ndarray, rho: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Return where each ray first rises through its half level past its darkest place, in radii, if it does.

    The darkest place, because in a small ring the blurred hole still shines where the search begins.
    """
    first = int(np.searchsorted(rho, _FIRST_EDGE))
    tail = profile[:, :, first:]
    darkest = tail[:, :, rho[first:] <= 1].argmin(axis=2)
    above = (tail >= half[..., None]) & (np.arange(tail.shape[2]) > darkest[..., None])
    at = above.argmax(axis=2)
    found = above.any(axis=2)
    at = np.maximum(at, 1)
    high = np.take_along_axis(tail, at[..., None], axis=2)[..., 0]
    low = np.take_along_axis(tail, at[..., None] - 1, axis=2)[..., 0]
    found &= low < half
    fraction = (half - low) / np.where(found, np.maximum(high - low, 1e-30), 1)
    return rho[first] + (at - 1 + fraction) * (rho[1] - rho[0]), found


def _ellipses(points: np.ndarray, found: np.ndarray) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Fit ``a x^2 + 2 b x y + c y^2 + d x + e y = 1`` to each spot's points, near the unit circle.

    Returns the centres, the inverse outline matrices and the median distance of the points from the ellipse,
    all in the coordinates of `points`; the distance is infinite where there is no ellipse.
    """
    x, y = points[..., 0], points[..., 1]
    design = np.stack([x * x, 2 * x * y, y * y, x, y], axis=-1)
    use = found
    ridge = 1e-9 * np.eye(5)
    for _ in range(3):
        weighted = design * use[..., None]
        normal = np.swapaxes(weighted, 1, 2) @ design + ridge
        a, b, c, d, e = np.linalg.solve(normal, weighted.sum(axis=1)[..., None])[..., 0].T
        residual = np.where(
            found, np.abs(np.einsum("nki,ni->nk", design, np.stack([a, b, c, d, e], -1)) - 1), np.inf
        )
        limit = np.maximum(4 * np.median(residual, axis=1), 0.02)  # the median of a spot without edges is inf
        use = found & (residual < limit[:, None])
    quadratic = np.stack([np.stack([a, b], -1), np.stack([b, c], -1)], -2)
    determinant = a * c - b * b
    sound = (determinant > 0.05) & (a > 0) & (use.sum(axis=1) >= _MIN_RAYS)  # noqa: PLR2004 - near 1 for ours
    quadratic[~sound] = np.eye(2)
    centre = -0.5 * np.linalg.solve(quadratic, np.stack([d, e], -1)[..., None])[..., 0]
    centre[~sound] = 0.0
    scale = 1 + np.einsum("ni,nij,nj->n", centre, quadratic, centre)
    sound &= np.linalg.norm(centre, axis=1) < 0.5  # noqa: PLR2004 - of the radius
    rough = np.where(
        sound, np.median(residual, axis=1) / 2, np.inf
    )  # the residual is that of the radius squared
    return centre, quadratic / scale[:, None, None], rough


def matrix_root(matrix: PixelCovariances) -> PixelCovariances:
    """Return the symmetric square roots of symmetric positive 2 x 2 matrices (by Cayley-Hamilton)."""
    root = np.sqrt(np.linalg.det(matrix))
    trace = np.trace(matrix, axis1=-2, axis2=-1)
    scale = np.sqrt(trace + 2 * root)
    result: np.ndarray = (matrix + root[..., None, None] * np.eye(2)) / scale[..., None, None]
    return result
