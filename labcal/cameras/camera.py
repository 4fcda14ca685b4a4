"""A camera: pixels to rays and points to pixels, in the world's frame."""

from dataclasses import dataclass
from functools import cached_property

import numpy as np

from labcal.arrays import Mask, Matrix3, Pixels, PointJacobians, Vectors3, Pose
from labcal.cameras.dual import Dual, DualMathematics, constants, variables
from labcal.cameras.lens import LENGTH, MOST_COEFFICIENTS, PRESCRIPTION, Lens, lens_by_name
from labcal.cameras.mathematics import NUMPY, Number, NumpyMathematics
from labcal.cameras.optics import INTRINSICS, Optics
from labcal.cameras.prescribed import PrescribedLens
from labcal.cameras.prescription import Prescription
from labcal.cameras.window import FlatWindow, WavyWindow
from labcal.errors import InputError
from labcal.geometry.poses import inverse, require_rigid, transform

_LATTICE = 65


@dataclass(frozen=True)
class Rays:
    """Where pixels look: a point on each ray, its unit direction, and whether there is a ray at all."""

    origin: Vectors3
    direction: Vectors3
    ok: Mask


@dataclass(frozen=True)
class Projection:
    """Where points are imaged; NaN and not ok for what the camera cannot image."""

    q: Pixels
    ok: Mask


@dataclass(frozen=True)
class Camera:
    """A camera with a lens model, at its place in the world.

    Parameters
    ----------
    K : ndarray, shape (3, 3)
        Camera matrix in pixels, without skew; pixel (0, 0) is the centre of the top-left pixel.
    lens : str
        Name of a lens model, or ``prescription``.
    dist : ndarray, shape (k,)
        Its coefficients in OpenCV's order, padded with zeros to at least 5.
    T_cam_world : ndarray, shape (4, 4)
        World to camera (x right, y down, z forward), mm.
    size : (int, int)
        Width and height of the picture, px.
    prescription : Prescription, optional
        The lens's surfaces, where `lens` is ``prescription``; its focal length is ``fx`` pixels.
    window : FlatWindow or WavyWindow, optional
        Glass in front of the lens.

    Raises
    ------
    InputError
        A matrix is malformed, there are more coefficients than the model has, the size is not positive, or a
        prescription is missing or out of place.
    UnknownNameError
        There is no such lens model.
    """

    K: Matrix3
    lens: str
    dist: np.ndarray
    T_cam_world: Pose
    size: tuple[int, int]
    prescription: Prescription | None = None
    window: FlatWindow | WavyWindow | None = None

    def __post_init__(self) -> None:
        if (self.lens == PRESCRIPTION) != (self.prescription is not None):
            raise InputError(
                f"A camera has a prescription if its lens is '{PRESCRIPTION}', and only then; here the lens "
                f"is '{self.lens}'. Set lens to '{PRESCRIPTION}', or leave out the prescription."
            )
        model = self.model
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
                f"The lens model '{self.lens}' has {model.coefficients} coefficients; the rest of dist must "
                "be 0. Shorten dist, or choose another lens."
            )
        if self.prescription is not None and fx != fy:
            raise InputError("A lens prescription images round things round: fx and fy must be equal.")
        if min(self.size) < 1:
            raise InputError(f"The picture size must be positive, but is {self.size[0]} x {self.size[1]}.")
        require_rigid(self.T_cam_world, "T_cam_world")

    @property
    def intrinsics(self) -> tuple[float, float, float, float]:
        """``fx, fy, cx, cy`` in pixels."""
        return (float(self.K[0, 0]), float(self.K[1, 1]), float(self.K[0, 2]), float(self.K[1, 2]))

    @cached_property
    def centre(self) -> Vectors3:
        """The centre of projection in the world, mm, shape (3,)."""
        return inverse(self.T_cam_world)[:3, 3]

    @cached_property
    def model(self) -> Lens:
        """The lens model."""
        return lens_by_name(self.lens) if self.prescription is None else PrescribedLens(self.prescription)

    @property
    def optics(self) -> Optics:
        """Lens and window, to which :attr:`numbers` belong."""
        return Optics(self.model, self.window)

    @cached_property
    def numbers(self) -> tuple[float, ...]:
        """All numbers of the camera: fx fy cx cy, then the window's and the lens model's own."""
        return (*self.intrinsics, *self._window_numbers, *self._lens_numbers)

    @cached_property
    def forward_numbers(self) -> tuple[float, ...]:
        """The leading :attr:`numbers`: all that the way from points to pixels takes."""
        return (*self.intrinsics, *self._window_numbers, *self._forward_lens_numbers)

    @property
    def reach(self) -> float:
        """Largest radius of the picture on the plane at unit focal length."""
        fx, fy, cx, cy = self.intrinsics
        width, height = self.size
        spare = 1.0 + (self.window.largest_px if isinstance(self.window, WavyWindow) else 0.0)
        x, y = max(cx, width - 1 - cx) + spare, max(cy, height - 1 - cy) + spare
        return float(np.hypot(x / fx, y / fy))

    @cached_property
    def newton_steps(self) -> int:
        """Newton steps after which the inverse of the lens is found everywhere in the picture."""
        q = self._lattice()
        with np.errstate(invalid="ignore", over="ignore"):
            there = self.optics.trace(NUMPY, self.numbers, *q).ok
            for steps in range(1, NUMPY.newton_steps):
                # Well short of what is asked for, since between the nodes it may be worse.
                m = NumpyMathematics(steps, settled=5e-5)
                if not np.any(there & ~self.optics.trace(m, self.numbers, *q).ok):
                    return steps
        return NUMPY.newton_steps

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
            traced = self.optics.trace(NUMPY, self.numbers, q[..., 0], q[..., 1])
            T_world_cam = inverse(self.T_cam_world)
            origin = transform(T_world_cam, np.stack(traced.origin, axis=-1))
            direction = np.stack(traced.direction, axis=-1) @ T_world_cam[:3, :3].T
        ok = np.asarray(traced.ok)
        return Rays(np.where(ok[..., None], origin, np.nan), np.where(ok[..., None], direction, np.nan), ok)

    def project(self, p: Vectors3) -> Projection:
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
        return self.image(transform(self.T_cam_world, p))

    def image(self, p_cam: Vectors3) -> Projection:
        """Return where points of the camera's frame are imaged, as :meth:`project` does.

        Parameters
        ----------
        p_cam : ndarray, shape (..., 3)
            Points, mm.
        """
        X, Y, Z = np.moveaxis(p_cam, -1, 0)
        with np.errstate(invalid="ignore", over="ignore", divide="ignore"):
            found = self.optics.project(NUMPY, self.forward_numbers, (X, Y, Z))
        ok = np.asarray(found.ok)
        return Projection(np.where(ok[..., None], np.stack([found.u, found.v], axis=-1), np.nan), ok)

    def point_jacobian(self, p: Vectors3) -> PointJacobians:
        """Return dq / dp at world points, shape (..., 2, 3), px/mm."""
        X, Y, Z = np.moveaxis(transform(self.T_cam_world, p), -1, 0)
        numbers = constants(self.forward_numbers, 3)
        with np.errstate(invalid="ignore", over="ignore", divide="ignore"):
            x, y, z = variables(X, Y, Z)
            found = self.optics.project(DualMathematics(NUMPY), numbers, (x, y, z))
        local = slopes_of(found.u.slopes, found.v.slopes, np.shape(X))
        jacobian: np.ndarray = local @ self.T_cam_world[:3, :3]
        return jacobian

    def intrinsic_jacobian(self, p: Vectors3) -> np.ndarray:
        """Return dq / d(fx, fy, cx, cy, coefficients) at world points, shape (..., 2, 4 + coefficients)."""
        free = self.model.coefficients
        X, Y, Z = np.moveaxis(transform(self.T_cam_world, p), -1, 0)
        varied = variables(*self.intrinsics, *self.padded_dist[:free])
        directions = INTRINSICS + free
        fixed = constants(self.padded_dist[free:], directions)
        m = DualMathematics(NUMPY)
        numbers = self.dual_numbers(m, varied[:INTRINSICS], (*varied[INTRINSICS:], *fixed))
        with np.errstate(invalid="ignore", over="ignore", divide="ignore"):
            x, y, z = constants((X, Y, Z), directions)
            found = self.optics.project(m, numbers, (x, y, z))
        return slopes_of(found.u.slopes, found.v.slopes, np.shape(X))

    def dual_numbers(
        self, m: DualMathematics, intrinsics: tuple[Dual, ...], dist: tuple[Dual, ...]
    ) -> tuple[Dual, ...]:
        """Return :attr:`forward_numbers` for derivatives by intrinsics and all of :attr:`padded_dist`."""
        directions = len(intrinsics[0].slopes)
        formula = self.model.formula(m, dist) if self.model.coefficients else ()
        rest = constants(self._forward_lens_numbers[len(formula) :], directions)
        return (*intrinsics, *constants(self._window_numbers, directions), *formula, *rest)

    def in_picture(self, q: Pixels) -> Mask:
        """Return whether pixels lie on the picture, which reaches half a pixel beyond the outer centres."""
        width, height = self.size
        inside = np.abs(q - 0.5 * np.array([width - 1, height - 1])) <= 0.5 * np.array([width, height])
        return np.asarray(inside.all(axis=-1))

    @cached_property
    def share_without_rays(self) -> float:
        """The share of a lattice over the picture whose pixels see no direction: the lens folds there."""
        return float((~self.rays(np.stack(self._lattice(), axis=-1)).ok).mean())

    def require_rays_everywhere(self, name: str) -> None:
        """Raise where the lens model folds, or has no inverse, within the picture.

        Raises
        ------
        InputError
            A pixel on a lattice over the picture has no ray.
        """
        q = np.stack(self._lattice(), axis=-1)
        lost = ~self.rays(q).ok
        if lost.any():
            q = q[lost][0]
            raise InputError(
                f"The lens of camera '{name}' ({self.lens}) folds within its picture: pixel "
                f"({q[0]:.1f}, {q[1]:.1f}) sees no direction. {self._mend}"
            )

    @property
    def _mend(self) -> str:
        """What helps where the picture reaches beyond the lens's field."""
        if self.prescription is not None:
            return "Raise focal_px, lessen the picture's size, or give the prescription wider surfaces."
        if self.model.ranges is not None:
            return "Raise the focal length, lessen the picture's size, or let the lens see farther."
        return "Weaken the distortion, or add coefficients that let it grow outwards."

    @property
    def padded_dist(self) -> tuple[float, ...]:
        """The coefficients, with zeros up to as many as any model has."""
        return (*(float(k) for k in self.dist), *(0.0,) * max(0, MOST_COEFFICIENTS - len(self.dist)))

    @cached_property
    def _window_numbers(self) -> tuple[float, ...]:
        return () if self.window is None else self.window.numbers

    @cached_property
    def _forward_lens_numbers(self) -> tuple[float, ...]:
        return self.model.forward_numbers(NUMPY, self.padded_dist)

    @cached_property
    def _lens_numbers(self) -> tuple[float, ...]:
        return self.model.numbers(NUMPY, self.padded_dist, self.reach)

    def _lattice(self) -> tuple[np.ndarray, np.ndarray]:
        """Return u and v of a lattice over the picture up to its very edges."""
        u = np.linspace(-0.5, self.size[0] - 0.5, _LATTICE)
        v = np.linspace(-0.5, self.size[1] - 0.5, _LATTICE)
        across, down = np.meshgrid(u, v)
        return across.ravel(), down.ravel()


def slopes_of(of_u: tuple[Number, ...], of_v: tuple[Number, ...], shape: tuple[int, ...]) -> np.ndarray:
    """Return the slopes of both coordinates as one array, shape (..., 2, directions)."""
    rows = [np.stack([np.broadcast_to(slope, shape) for slope in of], axis=-1) for of in (of_u, of_v)]
    return np.stack(rows, axis=-2)
