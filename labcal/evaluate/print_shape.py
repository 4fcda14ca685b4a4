"""The shape of a print from free dots: stretch, shear, bow, and displaced dots."""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from jaxtyping import Float64

from labcal.calibrate.adjustment.dot_freedom import Constrained
from labcal.calibrate.freed_dots import FreedDots

_WORST = 5


@dataclass(frozen=True)
class Figure:
    """A figure with its standard deviation; both NaN if the views do not determine it."""

    value: float
    sigma: float


@dataclass(frozen=True)
class DotShift:
    """The displacement of one dot from its declared place, mm."""

    col: int
    row: int
    dx_mm: float
    dy_mm: float
    dz_mm: float
    sigma_mm: tuple[float, float, float]


@dataclass(frozen=True)
class PrintShape:
    """Figures of a print. Its mean scale is the declared one: pictures alone do not determine lengths."""

    stretch_ppm: Figure
    """Scale along x minus scale along y."""
    shear_mrad: Figure
    """Deviation of the angle between rows and columns from a right angle."""
    bow_x_mm: Figure
    """Height of the middle over the ends of the grid along x, towards the camera."""
    bow_y_mm: Figure
    twist_mm: Figure
    """Height of the corner at large x and y, and of the opposite one, over the plane of the others' mean."""
    rms_in_plane_mm: float
    """Of the 2-D displacements, stretch and shear included."""
    rms_unexplained_mm: float
    """RMS of the remainder after removal of stretch and shear."""
    rms_height_mm: float
    sigma_in_plane_mm: float
    """RMS standard deviation of the 2-D places."""
    worst: tuple[DotShift, ...]
    """The dots with the largest displacement, without stretch, shear, bow and twist."""
    kept: tuple[tuple[int, int], ...]
    """(col, row) of the dots in too few pictures to be freed."""
    held: tuple[str, ...]
    """Parts that a datum constraint keeps as declared, since the views do not determine them."""


def print_shape(dots: FreedDots) -> PrintShape:
    """Return the shape of a print by unweighted fits to the freed dots; sigmas carry their covariance.

    Parameters
    ----------
    dots : FreedDots
    """
    freed = dots.freed
    p = dots.target.points()[freed]
    x, y = (p[:, :2] - p[:, :2].mean(axis=0)).T
    half_x, half_y = 0.5 * np.ptp(x), 0.5 * np.ptp(y)
    d = dots.displacement[freed]
    covariance = dots.covariance[freed][:, :, freed]
    o, one = np.zeros_like(x), np.ones_like(x)
    in_plane = np.stack(
        [np.stack(motion, axis=-1) for motion in ([one, o], [o, one], [x, o], [y, o], [o, x], [o, y])],
        axis=-1,
    ).reshape(-1, 6)
    plane, plane_cov = _fit(in_plane, d[:, :2].ravel(), _block(covariance, slice(0, 2)))
    heights = np.stack([one, x / half_x, y / half_y, (x / half_x) ** 2, (y / half_y) ** 2,
                        x * y / (half_x * half_y)], axis=-1)  # fmt: skip
    bent, bent_cov = _fit(heights, d[:, 2], _block(covariance, slice(2, 3)))
    rest = d - np.column_stack([(in_plane @ plane).reshape(-1, 2), heights @ bent])
    stretch_known, heights_known = (
        Constrained.STRETCH not in dots.constrained,
        Constrained.HEIGHTS not in dots.constrained,
    )
    return PrintShape(
        stretch_ppm=_figure(plane, plane_cov, 1e6 * np.array([0, 0, 1, 0, 0, -1.0]), known=stretch_known),
        shear_mrad=_figure(plane, plane_cov, 1e3 * np.array([0, 0, 0, 1.0, 1, 0]), known=stretch_known),
        bow_x_mm=_figure(bent, bent_cov, np.array([0, 0, 0, -1.0, 0, 0]), known=heights_known),
        bow_y_mm=_figure(bent, bent_cov, np.array([0, 0, 0, 0, -1.0, 0]), known=heights_known),
        twist_mm=_figure(bent, bent_cov, np.array([0, 0, 0, 0, 0, 1.0]), known=heights_known),
        rms_in_plane_mm=_rms(d[:, :2]),
        rms_unexplained_mm=_rms(rest[:, :2]),
        rms_height_mm=_rms(d[:, 2:]),
        sigma_in_plane_mm=_rms(dots.sigma[freed][:, :2]),
        worst=_worst(dots, rest),
        kept=tuple((int(col), int(row)) for col, row in dots.target.indices()[~freed]),
        held=tuple(part.name.lower() for part in Constrained if part in dots.constrained and part.name),
    )


def agreement(found: Sequence[FreedDots]) -> tuple[float, float]:
    """Return the correlations of x and of y displacements that two cameras found independently.

    Shift, rotation, scale, stretch and shear are taken out of both first: one camera alone leaves them open.

    Parameters
    ----------
    found : sequence of FreedDots
        Two of the same target.

    Returns
    -------
    (float, float)
        NaN where the cameras share fewer than 8 freed dots.
    """
    a, b = found
    shared = a.freed & b.freed
    if shared.sum() < 8:  # noqa: PLR2004 -- affine motions alone take three dots
        return (float("nan"), float("nan"))
    p = a.target.points()[shared]
    affine = np.column_stack([np.ones(len(p)), p[:, :2]])
    rest = []
    for dots in found:
        d = dots.displacement[shared, :2]
        rest.append(d - affine @ np.linalg.lstsq(affine, d, rcond=None)[0])
    along = [float(np.corrcoef(rest[0][:, axis], rest[1][:, axis])[0, 1]) for axis in (0, 1)]
    return (along[0], along[1])


def _block(covariance: np.ndarray, axes: slice) -> Float64[np.ndarray, "m m"]:
    """Return the covariance of some coordinates of all dots as a matrix."""
    part = covariance[:, axes, :, axes]
    size = part.shape[0] * part.shape[1]
    return np.asarray(part.reshape(size, size))


def _fit(design: np.ndarray, values: np.ndarray, covariance: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    inverse = np.linalg.pinv(design)
    return inverse @ values, inverse @ covariance @ inverse.T


def _figure(found: np.ndarray, covariance: np.ndarray, weights: np.ndarray, *, known: bool) -> Figure:
    if not known:
        return Figure(float("nan"), float("nan"))
    return Figure(float(weights @ found), float(np.sqrt(max(0.0, weights @ covariance @ weights))))


def _rms(d: np.ndarray) -> float:
    return float(np.sqrt((d**2).sum(axis=1).mean()))


def _worst(dots: FreedDots, rest: np.ndarray) -> tuple[DotShift, ...]:
    numbers = np.flatnonzero(dots.freed)
    farthest = np.argsort(-np.linalg.norm(rest, axis=1), kind="stable")[:_WORST]
    indices = dots.target.indices()
    worst = []
    for at in farthest.tolist():
        col, row = indices[numbers[at]].tolist()
        x, y, z = dots.sigma[numbers[at]].tolist()
        dx, dy, dz = rest[at].tolist()
        worst.append(DotShift(col, row, dx, dy, dz, (x, y, z)))
    return tuple(worst)
