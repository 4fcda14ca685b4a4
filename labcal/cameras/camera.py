"""A camera: pixels to rays and points to pixels, in the world's frame."""

from dataclasses import dataclass
from functools import cached_property

import numpy as np

from labcal.arrays import Mask, Matrix3, Pixels, PointJacobians, Points, Pose
from labcal.cameras.brown import LENGTH
from labcal.cameras.lens import lens_by_name
from labcal.cameras.mathematics import NUMPY, Mathematics, Number
from labcal.errors import InputError
from labcal.geometry.poses import inverse, require_rigid, transform


@dataclass(frozen=True)
class Rays:
    """Where pixels look: a point on each ray, its unit direction, and whether there is a ray at all."""

    origin: Points
    direction: Points
    ok: Mask


@dataclass(frozen=True)
class Projection:
    """Where points are imaged; NaN and not ok for what the camera cannot image."""

    q: Pixels
    ok: Mask


@dataclass(frozen=True)
class Trace:
    """A ray in the camera frame, component by component, in the caller's kind of number."""

    origin: tuple[Number, Number, Number]
    direction: tuple[Number, Number, Number]
    ok: Number


@dataclass(frozen=True)
class Camera:
    """A camera with a lens model, at its place in the world.

    Parameters
    ----------
    K : ndarray, shape (3, 3)
        Camera matrix in pixels, without skew; pixel (0, 0) is the centre of the top-left pixel.
    lens : str
        Name of a lens model.
    dist : ndarray, shape (k,)
        Its coefficients in OpenCV's order, padded with zeros to at least 5.
    T_cam_world : ndarray, shape (4, 4)
        World to camera (x right, y down, z forward), mm.
    size : (int, int)
        Width and height of the picture, px.

    Raises
    ------
    InputError
        A matrix is malformed, there are more coefficients than the model has, or the size is not positive.
    UnknownNameError
        There is no such lens model.
    """

    K: Matrix3
    lens: str
    dist: np.ndarray
    T_cam_world: Pose
    size: tuple[int, int]

    def __post_init__(self) -> None:
        model = lens_by_name(self.lens)
        fx, fy, cx, cy = self.intrinsics
        expected = np.array([[fx, 0.0, cx], [0.0, fy, cy], [0.0, 0.0, 1.0]])
        if not (np.isfinite(self.K).all() and np.array_equal(self.K, expected) and min(fx, fy) > 0):
            raise InputError(
                "K must be [[fx, 0, cx], [0, fy, cy], [0, 0, 1]] with positive focal lengths in pixels."
            )
        if self.dist.ndim != 1 or len(self.dist) < LENGTH or not np.isfinite(self.dist).all():
            raise InputError(f"dist must hold at least {LENGTH} finite coefficients; pad it with zeros.")
        if np.any(self.dist[model.coefficients :] != 0.0):
            raise InputError(
                f"The lens model '{self.lens}' has {model.coefficients} coefficients; the rest must be 0."
            )
        if min(self.size) < 1:
            raise InputError(f"The picture size must be positive, but is {self.size[0]} x {self.size[1]}.")
        require_rigid(self.T_cam_world, "T_cam_world")

    @property
    def intrinsics(self) -> tuple[float, float, float, float]:
        """``fx, fy, cx, cy`` in pixels."""
        return (float(self.K[0, 0]), float(self.K[1, 1]), float(self.K[0, 2]), float(self.K[1, 2]))

    @cached_property
    def centre(self) -> Points:
        """The centre of projection in the world, mm, shape (3,)."""
        return inverse(self.T_cam_world)[:3, 3]

    @cached_property
    def numbers(self) -> tuple[float, ...]:
        """All numbers of the lens formula: fx fy cx cy, then the lens model's own."""
        return (*self.intrinsics, *lens_by_name(self.lens).numbers(self.dist))

    def trace(self, m: Mathematics, numbers: tuple[Number, ...], u: Number, v: Number) -> Trace:
        """Follow the ray of pixel (u, v) out of the camera, in the camera frame.

        Parameters
        ----------
        m : Mathematics
            The functions on the caller's kind of number.
        numbers : tuple
            :attr:`numbers` in that kind.
        u, v : number
            Pixel position.
        """
        fx, fy, cx, cy, *coefficients = numbers
        X, Y, Z, ok = lens_by_name(self.lens).direction(m, tuple(coefficients), (u - cx) / fx, (v - cy) / fy)
        zero = 0.0 * Z
        return Trace((zero, zero, zero), (X, Y, Z), ok)

    def rays(self, q: Pixels) -> Rays:
        """Return the rays of pixels, in the world.

        Parameters
        ----------
        q : ndarray, shape (..., 2)
            Pixels; they may lie outside the picture.

        Returns
        -------
        Rays
            Points in mm and unit directions; NaN and not ok where the lens formula has no inverse.
        """
        with np.errstate(invalid="ignore", over="ignore"):
            traced = self.trace(NUMPY, self.numbers, q[..., 0], q[..., 1])
        T_world_cam = inverse(self.T_cam_world)
        origin = transform(T_world_cam, np.stack(traced.origin, axis=-1))
        direction = np.stack(traced.direction, axis=-1) @ T_world_cam[:3, :3].T
        ok = np.asarray(traced.ok)
        return Rays(np.where(ok[..., None], origin, np.nan), np.where(ok[..., None], direction, np.nan), ok)

    def project(self, p: Points) -> Projection:
        """Return where world points are imaged.

        Parameters
        ----------
        p : ndarray, shape (..., 3)
            World points, mm.

        Returns
        -------
        Projection
            Pixels, also outside the picture; NaN and not ok behind the camera, beyond the fold of the lens
            model and for NaN.
        """
        p_cam = transform(self.T_cam_world, p)
        fx, fy, cx, cy, *coefficients = self.numbers
        with np.errstate(invalid="ignore", over="ignore"):
            x, y, ok = lens_by_name(self.lens).image(
                NUMPY, tuple(coefficients), p_cam[..., 0], p_cam[..., 1], p_cam[..., 2]
            )
        q = np.stack([fx * x + cx, fy * y + cy], axis=-1)
        ok = np.asarray(ok)
        return Projection(np.where(ok[..., None], q, np.nan), ok)

    def point_jacobian(self, p: Points) -> PointJacobians:
        """Return dq / dp at world points, shape (..., 2, 3), px/mm."""
        p_cam = transform(self.T_cam_world, p)
        fx, fy, _, _, *coefficients = self.numbers
        ideal = lens_by_name(self.lens).image_jacobian(tuple(coefficients), *np.moveaxis(p_cam, -1, 0))
        jacobian: np.ndarray = np.array([[fx], [fy]]) * ideal @ self.T_cam_world[:3, :3]
        return jacobian

    def intrinsic_jacobian(self, p: Points) -> np.ndarray:
        """Return dq / d(fx, fy, cx, cy, coefficients) at world points, shape (..., 2, 4 + coefficients)."""
        model = lens_by_name(self.lens)
        p_cam = np.moveaxis(transform(self.T_cam_world, p), -1, 0)
        fx, fy, _, _, *coefficients = self.numbers
        x, y, _ = model.image(NUMPY, tuple(coefficients), p_cam[0], p_cam[1], p_cam[2])
        jacobian = np.zeros((*np.shape(x), 2, 4 + model.coefficients))
        jacobian[..., 0, 0] = x
        jacobian[..., 1, 1] = y
        jacobian[..., 0, 2] = 1.0
        jacobian[..., 1, 3] = 1.0
        jacobian[..., 4:] = np.array([[fx], [fy]]) * model.coefficient_jacobian(p_cam[0], p_cam[1], p_cam[2])
        return jacobian

    def in_picture(self, q: Pixels) -> Mask:
        """Return whether pixels lie on the picture, which reaches half a pixel beyond the outer centres."""
        width, height = self.size
        inside = np.abs(q - 0.5 * np.array([width - 1, height - 1])) <= 0.5 * np.array([width, height])
        return np.asarray(inside.all(axis=-1))

    def require_rays_everywhere(self, name: str) -> None:
        """Raise where the lens model folds, or has no inverse, within the picture.

        Raises
        ------
        InputError
            A pixel of the picture's border has no ray.
        """
        width, height = self.size
        u = np.linspace(-0.5, width - 0.5, 65)
        v = np.linspace(-0.5, height - 0.5, 65)
        border = np.concatenate(
            [np.stack([u, np.full_like(u, edge)], axis=-1) for edge in (-0.5, height - 0.5)]
            + [np.stack([np.full_like(v, edge), v], axis=-1) for edge in (-0.5, width - 0.5)]
        )
        lost = ~self.rays(border).ok
        if lost.any():
            q = border[lost][0]
            raise InputError(
                f"The lens of camera '{name}' ({self.lens}) folds within its picture: pixel "
                f"({q[0]:.0f}, {q[1]:.0f}) "
                "sees no direction. Weaken the distortion, or add coefficients that let it grow outwards."
            )
