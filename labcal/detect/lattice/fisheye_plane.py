"""A plane seen through an equidistant fisheye of unknown focal length, fitted to the nodes of a grid."""

from dataclasses import dataclass

import numpy as np
from jaxtyping import Float64

from labcal.arrays import Pixels

_WIDEST = float(np.radians(340.0))
_NARROWEST = float(np.radians(60.0))
"""Diagonal fields of view between which the focal length is sought."""
_CLOSE = 1e-3
"""Relative accuracy of the focal length that is enough."""
_STEP = 1e-4
"""Of a scaled node, for derivatives."""


@dataclass(frozen=True)
class FisheyePlane:
    """A plane's nodes imaged by an equidistant fisheye about the middle of the picture.

    Unlike a plane in an undistorted picture, it reaches beyond 180 degrees.

    Attributes
    ----------
    centre : ndarray, shape (2,)
        Where the axis meets the picture, px.
    focal : float
        px.
    H : ndarray, shape (3, 3)
        Homography from nodes (a, b, 1) to directions of the camera's frame, up to length.
    """

    centre: np.ndarray
    focal: float
    H: np.ndarray

    def project(self, nodes: Float64[np.ndarray, "n 2"]) -> Pixels:
        """Return the pixels of nodes."""
        direction = _homogeneous(nodes) @ self.H.T
        across = np.maximum(np.hypot(direction[:, 0], direction[:, 1]), 1e-12)
        angle = np.arctan2(across, direction[:, 2])
        seen: Pixels = self.centre + self.focal * (angle / across)[:, None] * direction[:, :2]
        return seen

    def residuals(self, nodes: Float64[np.ndarray, "n 2"], seen: Pixels) -> Float64[np.ndarray, "n 2"]:
        """Return seen minus projected places along both axes, in units of the nodes; NaN edge-on."""
        there = self.project(nodes)
        slopes = np.stack(
            [(self.project(nodes + _STEP * axis) - there) / _STEP for axis in np.eye(2)], axis=-1
        )
        flat = np.abs(np.linalg.det(slopes)) < _STEP * (slopes**2).sum(axis=(1, 2))
        slopes[flat] = np.nan
        off: np.ndarray = np.linalg.solve(slopes, (seen - there)[..., None])[..., 0]
        return off


def fitted_fisheye_plane(
    nodes: Float64[np.ndarray, "n 2"], seen: Pixels, size: tuple[int, int]
) -> FisheyePlane | None:
    """Fit a plane and a focal length to nodes, by the least squares of their pixels over the focal length.

    Parameters
    ----------
    nodes : ndarray, shape (n, 2)
        Of unit size about.
    seen : ndarray, shape (n, 2)
        Their pixels.
    size : tuple of int
        Width and height of the picture, px.

    Returns
    -------
    FisheyePlane or None
        None where a node would lie behind the camera.
    """
    from scipy.optimize import minimize_scalar  # noqa: PLC0415 -- takes half a second to import

    centre, diagonal = (np.array(size, dtype=np.float64) - 1.0) / 2.0, float(np.hypot(*size))

    def misfit(field: float) -> float:
        plane = _plane(nodes, seen, centre, diagonal / field)
        return float(((plane.project(nodes) - seen) ** 2).sum())

    found = minimize_scalar(
        misfit, bounds=(_NARROWEST, _WIDEST), method="bounded", options={"xatol": _CLOSE * _WIDEST}
    )
    plane = _plane(nodes, seen, centre, diagonal / float(found.x))
    ahead = ((_homogeneous(nodes) @ plane.H.T) * _directions(seen, centre, plane.focal)).sum(axis=1)
    return plane if (ahead > 0).all() else None


def _plane(nodes: Float64[np.ndarray, "n 2"], seen: Pixels, centre: np.ndarray, focal: float) -> FisheyePlane:
    """Return the plane under a focal length whose directions are those of the pixels (DLT)."""
    d, places = _directions(seen, centre, focal), _homogeneous(nodes)
    none = np.zeros_like(places)
    rows = np.concatenate(
        [
            np.concatenate([none, -d[:, 2:] * places, d[:, 1:2] * places], axis=1),
            np.concatenate([d[:, 2:] * places, none, -d[:, :1] * places], axis=1),
            np.concatenate([-d[:, 1:2] * places, d[:, :1] * places, none], axis=1),
        ]
    )
    H = np.linalg.eigh(rows.T @ rows)[1][:, 0].reshape(3, 3)
    ahead = float(np.median(((places @ H.T) * d).sum(axis=1)))
    return FisheyePlane(centre, focal, H if ahead >= 0 else -H)


def _directions(seen: Pixels, centre: np.ndarray, focal: float) -> Float64[np.ndarray, "n 3"]:
    """Return the unit directions of pixels."""
    away = (seen - centre) / focal
    angle = np.maximum(np.hypot(away[:, 0], away[:, 1]), 1e-12)
    across = away * (np.sin(angle) / angle)[:, None]
    return np.concatenate([across, np.cos(angle)[:, None]], axis=1)


def _homogeneous(nodes: Float64[np.ndarray, "n 2"]) -> Float64[np.ndarray, "n 3"]:
    return np.concatenate([nodes, np.ones((len(nodes), 1))], axis=1)
