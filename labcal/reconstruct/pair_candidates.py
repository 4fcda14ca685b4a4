"""Pairs of pixels of two cameras that may show the same point: their rays meet, within their errors."""

from dataclasses import dataclass

import numpy as np
from jaxtyping import Float64, Int64

from labcal.arrays import Vectors3
from labcal.cameras.camera import Camera
from labcal.cameras.parameter_derivatives import POSE, parameter_derivatives, parameter_slices
from labcal.cameras.triangulation import triangulate
from labcal.distributions import chi2_upper_quantile

_MISSED = 1e-3
"""Probability that the pair of a dot is no candidate."""
_GATE_PX = 8.0
"""Distance of rays, as pixels, beyond which no calibration that is of use explains a pair."""
_AT_A_TIME = 2**18


@dataclass(frozen=True)
class Pair:
    """Two cameras, with what is known of their errors.

    Attributes
    ----------
    cameras : tuple of Camera
        Two.
    parameters : ndarray, shape (parameters, parameters) or None
        Joint covariance of both cameras' lenses and of both poses, as `parameter_columns` orders them; None
        where the calibration states none.
    scatter_px : float
        What the calibration adds to the noise of pixels along each axis.
    """

    cameras: tuple[Camera, Camera]
    parameters: Float64[np.ndarray, "parameters parameters"] | None
    scatter_px: float


@dataclass(frozen=True)
class Candidates:
    """Pairs of pixels that may show the same point.

    Attributes
    ----------
    first, second : ndarray of int, shape (n,)
        Numbers of the pixels in either camera.
    point : ndarray, shape (n, 3)
        Where their rays meet, mm.
    """

    first: Int64[np.ndarray, " n"]
    second: Int64[np.ndarray, " n"]
    point: Vectors3

    def where(self, mask: np.ndarray) -> "Candidates":
        """Return some of them, by mask or by number."""
        return Candidates(self.first[mask], self.second[mask], self.point[mask])


def pair_candidates(
    pair: Pair, q: tuple[np.ndarray, np.ndarray], covariance: tuple[np.ndarray, np.ndarray]
) -> Candidates:
    """Return the pairs of pixels whose epipolar residual noise and calibration explain.

    Parameters
    ----------
    pair : Pair
    q : tuple of ndarray, shapes (n, 2) and (m, 2)
        Pixels of either camera.
    covariance : tuple of ndarray, shapes (n, 2, 2) and (m, 2, 2)
        Of these, px squared.

    Notes
    -----
    The four coordinates of a pair determine three of a point; what is left is one residual. With the normal u
    of the point's derivatives in whitened pixels, its variance is 1 by noise and ``u' G P G' u`` by the
    cameras, where G are the derivatives of pixels by the cameras' parameters and P their covariance.
    """
    first, second = _near(pair.cameras, q)
    extra = pair.scatter_px**2 * np.eye(2)
    S = np.stack([covariance[0][first], covariance[1][second]], axis=1) + extra
    both = np.stack([q[0][first], q[1][second]], axis=1)
    p = triangulate(pair.cameras, both, S).point
    there = np.isfinite(p).all(axis=1)
    first, second, S, both, p = first[there], second[there], S[there], both[there], p[there]
    if not len(first):
        return Candidates(first, second, p)
    chi_square = _chi_square(pair, p, both, S)
    likely = chi_square < chi2_upper_quantile(_MISSED, 1)
    return Candidates(first, second, p).where(likely)


def _near(cameras: tuple[Camera, Camera], q: tuple[np.ndarray, np.ndarray]) -> tuple[np.ndarray, np.ndarray]:
    """Return the pairs whose rays pass each other at a few pixels, in front of both cameras."""
    rays = [camera.rays(pixels) for camera, pixels in zip(cameras, q, strict=True)]
    angle = [
        np.linalg.norm(camera.rays(pixels + np.array([1.0, 0.0])).direction - ray.direction, axis=1)
        for camera, pixels, ray in zip(cameras, q, rays, strict=True)
    ]
    found = []
    rows = max(1, _AT_A_TIME // max(1, len(q[1])))
    for start in range(0, len(q[0]), rows):
        part = slice(start, start + rows)
        v, w = rays[0].direction[part, None], rays[1].direction[None]
        between = rays[1].origin[None] - rays[0].origin[part, None]
        normal = np.cross(v, w)
        size = np.maximum((normal**2).sum(axis=2), 1e-24)
        away = np.abs((between * normal).sum(axis=2)) / np.sqrt(size)
        s = (np.cross(between, w) * normal).sum(axis=2) / size
        t = (np.cross(between, v) * normal).sum(axis=2) / size
        with np.errstate(invalid="ignore"):
            limit = _GATE_PX * np.maximum(s * angle[0][part, None], t * angle[1][None])
            near = (s > 0.0) & (t > 0.0) & (away < limit)
        i, j = np.nonzero(near)
        found.append((i + start, j))
    if not found:
        nothing = np.zeros(0, dtype=np.int64)
        return nothing, nothing
    first, second = (np.concatenate(part) for part in zip(*found, strict=True))
    return first, second


def _chi_square(pair: Pair, p: Vectors3, q: np.ndarray, S: np.ndarray) -> np.ndarray:
    """Return the squares of epipolar residuals over their variances."""
    L = np.linalg.cholesky(S)
    by_point, by_cameras, off = [], [], []
    for number, camera in enumerate(pair.cameras):
        found, own = parameter_derivatives(camera, p), L[:, number]
        by_point.append(np.linalg.solve(own, found.by_point))
        off.append(np.linalg.solve(own, (found.q - q[:, number])[..., None])[..., 0])
        by_cameras.append(np.linalg.solve(own, found.by_parameters))
    A = np.concatenate(by_point, axis=1)
    u = np.linalg.svd(A, full_matrices=True)[0][:, :, 3]
    residual = (u * np.concatenate(off, axis=1)).sum(axis=1)
    variance = np.ones(len(p))
    if pair.parameters is not None:
        g = np.concatenate(
            [np.einsum("ni,nij->nj", u[:, 2 * k : 2 * k + 2], by) for k, by in enumerate(by_cameras)], axis=1
        )
        variance += np.einsum("ni,ij,nj->n", g, pair.parameters, g)
    return np.asarray(residual**2 / variance)


def parameter_columns(cameras: list[Camera], first: int, second: int) -> list[int]:
    """Return where the parameters of two cameras stand among those of a rig; -1 where there is none.

    Parameters
    ----------
    cameras : list of Camera
        Of the rig.
    first, second : int
        Numbers of the two.
    """
    columns = [list(range(place.start, place.stop)) for place in parameter_slices(cameras)]
    columns[0] += [-1] * POSE
    return [*columns[first], *columns[second]]
