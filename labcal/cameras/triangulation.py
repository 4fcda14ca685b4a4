"""From pixels in several cameras to points, with covariances, and the epipolar distance between pixels."""

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Protocol, runtime_checkable

import numpy as np
from jaxtyping import Float64

from labcal.arrays import AnyArray, Mask, PointCovariances, Vectors3, float_array
from labcal.cameras.camera import Camera
from labcal.cameras.derivatives import RUN, Imaged, imaged
from labcal.geometry.covariances import clearly_definite, inverses, positive_definite
from labcal.geometry.rays import closest_points

STEPS = 10
"""Most Gauss-Newton steps; from the rays' meeting point three are enough."""
_ARRIVED_MM = 1e-9
"""Step of all points below which the next one, which is smaller by far, is of no use."""
_PAIR = 2
"""Cameras that a point takes at least."""
_CLEARLY = 1e-10
"""Share of its trace above which the least eigenvalue of a normal matrix leaves no doubt."""
_RESOLVED = 1e14
"""Condition of a normal matrix beyond which float64 resolves no point."""


@runtime_checkable  # so that tests can check annotations
class Imager(Protocol):
    """A model that projects points: a camera, or one with fitted corrections."""

    def imaged(self, p: Vectors3) -> Imaged:
        """Return the pixels of world points, mm, and their derivatives."""


@dataclass(frozen=True)
class KnownCamera:
    """A camera as it is; an `Imager`."""

    camera: Camera

    def imaged(self, p: Vectors3) -> Imaged:
        """Return the pixels of world points, mm, and their derivatives."""
        return imaged(self.camera, p)


@dataclass(frozen=True)
class TriangulatedPoints:
    """Points in the world; NaN and not ok where the pixels determine none."""

    point: Vectors3
    """(n, 3), mm."""
    covariance: PointCovariances
    """(n, 3, 3), mm squared, from the covariances of the pixels; the cameras count as exact."""
    ok: Mask
    """(n,)"""


def triangulate(cameras: Sequence[Camera], q: AnyArray, covariance: AnyArray) -> TriangulatedPoints:
    """Return the points whose images lie nearest to the given pixels, weighted by their covariances.

    Parameters
    ----------
    cameras : sequence of Camera
        At least two, in the order of `q`.
    q : array_like, shape (n, cameras, 2)
        Pixels of the same points.
    covariance : array_like, shape (n, cameras, 2, 2)
        Their covariances, px squared.

    Raises
    ------
    InputError, InputTypeError
        An array has another shape, or is not made of numbers.

    Examples
    --------
    >>> from labcal import examples
    >>> pair = [examples.rig().camera(name) for name in ("left", "right")]
    >>> q = [[camera.project([20, 10, 500]).q for camera in pair]]
    >>> triangulate(pair, q, [[np.eye(2), np.eye(2)]]).point.round(6)
    array([[ 20.,  10., 500.]])

    Notes
    -----
    Gauss-Newton on the reprojection error from the point nearest to all rays; with normal pixel noise this is
    the maximum-likelihood point, and the inverse normal matrix its covariance.
    """
    q = float_array(q, ("n", len(cameras), 2), "q")
    covariance = float_array(covariance, (len(q), len(cameras), 2, 2), "covariance")
    return refined([KnownCamera(camera) for camera in cameras], nearest_points(cameras, q), q, covariance)


def nearest_points(cameras: Sequence[Camera], q: Float64[np.ndarray, "n cameras 2"]) -> Vectors3:
    """Return the points nearest to the rays of pixels, mm, as mere geometry; NaN where there is none."""
    rays = [camera.rays(q[:, i]) for i, camera in enumerate(cameras)]
    origins = np.stack([ray.origin for ray in rays], axis=1)
    return closest_points(origins, np.stack([ray.direction for ray in rays], axis=1))


def refined(
    imagers: Sequence[Imager],
    start: Vectors3,
    q: Float64[np.ndarray, "n cameras 2"],
    covariance: Float64[np.ndarray, "n cameras 2 2"],
) -> TriangulatedPoints:
    """Return the points of :func:`triangulate` for anything that images points, from a start.

    Parameters
    ----------
    imagers : sequence of Imager
        At least two, in the order of `q`.
    start : ndarray, shape (n, 3)
        Millimetres; NaN for points without one.
    q, covariance
        As of :func:`triangulate`.
    """
    p = start.copy()
    known = positive_definite(covariance).all(axis=1) & np.isfinite(p).all(axis=1)
    weight = inverses(np.where(known[:, None, None, None], covariance, np.eye(2)))
    cov = np.full((len(q), 3, 3), np.nan)
    for _ in range(STEPS):
        normal, gradient = _normal_equations(imagers, p, q, weight)
        known = known & np.isfinite(gradient).all(axis=1) & np.isfinite(normal).all(axis=(1, 2))
        known[known] = _resolved(normal[known])
        cov[known] = np.linalg.inv(normal[known])
        step = np.einsum("nij,nj->ni", cov[known], gradient[known])
        p[known] -= step
        if not (np.abs(step) > _ARRIVED_MM).any():
            break
    p[~known] = np.nan
    cov[~known] = np.nan
    return TriangulatedPoints(p, cov, known)


def _normal_equations(
    imagers: Sequence[Imager], p: np.ndarray, q: np.ndarray, weight: np.ndarray
) -> tuple[np.ndarray, np.ndarray]:
    normal = np.zeros((len(p), 3, 3))
    gradient = np.zeros((len(p), 3))
    for first in range(0, len(p), RUN):
        rows = slice(first, first + RUN)
        for i, imager in enumerate(imagers):
            found = imager.imaged(p[rows])
            residual = found.q - q[rows, i]
            WJ = weight[rows, i] @ found.by_point
            normal[rows] += np.einsum("nki,nkj->nij", found.by_point, WJ)
            gradient[rows] += np.einsum("nki,nk->ni", WJ, residual)
    return normal, gradient


def _resolved(normal: Float64[np.ndarray, "n 3 3"]) -> Mask:
    """Return a mask of normal matrices that float64 can invert; of symmetric ones eigenvalues tell it."""
    resolved = clearly_definite(normal, _CLEARLY)
    spread = np.linalg.eigvalsh(normal[~resolved])
    resolved[~resolved] = spread[:, 0] * _RESOLVED > spread[:, -1]
    return resolved


def triangulation_limit(cameras: Sequence[Camera], p: AnyArray, covariance: AnyArray) -> PointCovariances:
    """Return the Cramer-Rao bound of points seen by exactly known cameras, shape (n, 3, 3), mm squared.

    Parameters
    ----------
    cameras : sequence of Camera
        The true cameras.
    p : array_like, shape (n, 3)
        True points, mm.
    covariance : array_like, shape (n, cameras, 2, 2)
        Covariances of the pixel positions, px squared.

    Raises
    ------
    InputError, InputTypeError
        `p` or `covariance` has another shape, or is not made of numbers.
    """
    p = float_array(p, ("n", 3), "p")
    covariance = float_array(covariance, (len(p), len(cameras), 2, 2), "covariance")
    q = np.stack([camera.project(p).q for camera in cameras], axis=1)
    return covariance_at([KnownCamera(camera) for camera in cameras], p, q, covariance)


def covariance_at(
    imagers: Sequence[Imager],
    p: Vectors3,
    q: Float64[np.ndarray, "n cameras 2"],
    covariance: Float64[np.ndarray, "n cameras 2 2"],
) -> PointCovariances:
    """Return the covariances of points, (n, 3, 3), mm squared, by those of their exact pixels.

    They are NaN where the pixels do not determine a point.

    Parameters
    ----------
    imagers : sequence of Imager
        At least two, in the order of `q`.
    p : ndarray, shape (n, 3)
        Millimetres.
    q : ndarray, shape (n, cameras, 2)
        The images of the points.
    covariance : ndarray, shape (n, cameras, 2, 2)
        Px squared.
    """
    normal, _ = _normal_equations(imagers, p, q, np.linalg.inv(covariance))
    known = np.isfinite(normal).all(axis=(1, 2))
    known[known] = _resolved(normal[known])
    found = np.full_like(normal, np.nan)
    found[known] = np.linalg.inv(normal[known])
    return found


def noise_covariance(
    imagers: Sequence[Imager],
    p: Vectors3,
    covariance: Float64[np.ndarray, "n cameras 2 2"],
    extra: float,
) -> PointCovariances:
    """Return the covariances of triangulated points whose pixels scatter more than they were weighted by.

    Parameters
    ----------
    imagers : sequence of Imager
        At least two, in the order of `covariance`.
    p : ndarray, shape (n, 3)
        Points as triangulated, mm; NaN where there is none.
    covariance : ndarray, shape (n, cameras, 2, 2)
        Covariances of pixels, px squared, by which the points were triangulated; NaN of cameras that took no
        part in a point.
    extra : float
        Variance of pixels along each axis beyond these, px squared.

    Returns
    -------
    ndarray, shape (n, 3, 3)
        Mm squared; NaN where there is no point.
    """
    found = np.full((len(p), 3, 3), np.nan)
    taking_part = positive_definite(covariance)
    known = np.flatnonzero(np.isfinite(p).all(axis=1) & (taking_part.sum(axis=1) >= _PAIR))
    for first in range(0, len(known), RUN):
        rows = known[first : first + RUN]
        normal, beyond = np.zeros((2, len(rows), 3, 3))
        for i, imager in enumerate(imagers):
            at = taking_part[rows, i]
            by_point = imager.imaged(p[rows[at]]).by_point
            weighted = inverses(covariance[rows[at], i]) @ by_point
            normal[at] += by_point.transpose(0, 2, 1) @ weighted
            beyond[at] += weighted.transpose(0, 2, 1) @ weighted
        own = np.linalg.inv(normal)
        found[rows] = own + extra * (own @ beyond @ own)
    return found


def epipolar_distances(camera_a: Camera, camera_b: Camera, q_a: AnyArray, q_b: AnyArray) -> np.ndarray:
    """Return how far pixels of `camera_b` lie from the epipolar curves of their partners in `camera_a`.

    Parameters
    ----------
    camera_a, camera_b : Camera
        Any lens: the curve is followed through the camera models.
    q_a, q_b : array_like, shape (n, 2)
        Pixels of the same points.

    Returns
    -------
    ndarray, shape (n,)
        Signed distance in px of camera b; NaN where there is no ray.

    Raises
    ------
    InputError, InputTypeError
        `q_a` or `q_b` has another shape, or is not made of numbers.
    """
    q_a = float_array(q_a, ("n", 2), "q_a")
    q_b = float_array(q_b, (len(q_a), 2), "q_b")
    rays_a, rays_b = camera_a.rays(q_a), camera_b.rays(q_b)
    p = closest_points(
        np.stack([rays_a.origin, rays_b.origin], axis=1),
        np.stack([rays_a.direction, rays_b.direction], axis=1),
    )
    along = np.einsum("ni,ni->n", p - rays_a.origin, rays_a.direction)[:, None]
    on_ray = rays_a.origin + along * rays_a.direction
    q_curve = camera_b.project(on_ray).q
    with np.errstate(divide="ignore", invalid="ignore"):  # cameras in one place have no epipolar curves
        tangent = np.einsum("nij,nj->ni", camera_b.point_jacobian(on_ray), rays_a.direction)
        tangent /= np.linalg.norm(tangent, axis=1, keepdims=True)
    offset = q_b - q_curve
    return np.asarray(tangent[:, 0] * offset[:, 1] - tangent[:, 1] * offset[:, 0])
