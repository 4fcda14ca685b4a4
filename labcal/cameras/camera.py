"""A camera: pixels to rays and points to pixels, in the world's frame."""

from collections.abc import Mapping
from dataclasses import dataclass
from functools import cached_property
from typing import TYPE_CHECKING

import numpy as np

from labcal.arguments import object_of, one_text, wrong_type
from labcal.arrays import (
    AnyArray,
    Mask,
    Matrix3,
    PointJacobians,
    Pose,
    Vectors3,
    float_array,
    kept,
    whole_array,
)
from labcal.cameras.camera_description import camera_description
from labcal.cameras.imaging import Projection, Rays
from labcal.cameras.jacobians import intrinsic_jacobian, point_jacobian
from labcal.cameras.lens import MOST_COEFFICIENTS, Lens, lens_by_name
from labcal.cameras.mathematics import NUMPY
from labcal.cameras.optics import Optics
from labcal.cameras.possible_camera import require_possible
from labcal.cameras.prescribed import PrescribedLens
from labcal.cameras.prescription import Prescription
from labcal.cameras.window import FlatWindow, WavyWindow
from labcal.geometry.poses import inverse, transform
from labcal.public_object import PublicObject

if TYPE_CHECKING:
    import matplotlib.figure

_LATTICE = 65


@dataclass(frozen=True, init=False, eq=False, repr=False)
class Camera(PublicObject):
    """A camera with a lens model, at its place in the world.

    Two cameras are equal where all their parameters are. A camera has no file of its own: a
    :class:`~labcal.cameras.rig.Rig` of one has.

    Parameters
    ----------
    K : array_like, shape (3, 3)
        Camera matrix in pixels, without skew; pixel (0, 0) is the centre of the top-left pixel. `fx` and `fy`
        of a lens with parallel rays are px/mm.
    lens : str
        Name of a lens model, or ``prescription``.
    dist : array_like, shape (k,)
        Its coefficients in OpenCV's order, padded with zeros to at least 5.
    T_cam_world : array_like, shape (4, 4)
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
        A matrix is malformed, there are more coefficients than the model has, the size is not positive, a
        prescription is missing or out of place, or a flat window is in front of a lens with parallel rays.
    InputTypeError
        What should be an array of numbers is none.
    UnknownNameError
        There is no such lens model.

    Examples
    --------
    >>> import numpy as np
    >>> from labcal import Camera
    >>> K = [[800, 0, 319.5], [0, 800, 239.5], [0, 0, 1]]
    >>> camera = Camera(K, "brown5", [-0.1, 0, 0, 0, 0], np.eye(4), (640, 480))
    >>> camera
    Camera(lens=brown5, size=640 x 480 px, focal_length=800.0, 800.0 px, field=44.3 x 33.7 deg)
    >>> camera.project([[0, 0, 1000], [100, 0, 1000]]).q.round(3)
    array([[319.5 , 239.5 ],
           [399.42, 239.5 ]])
    """

    K: Matrix3
    lens: str
    dist: np.ndarray
    T_cam_world: Pose
    size: tuple[int, int]
    prescription: Prescription | None = None
    window: FlatWindow | WavyWindow | None = None

    def __init__(  # noqa: PLR0913, PLR0917 -- as many as fields
        self,
        K: AnyArray,
        lens: str,
        dist: AnyArray,
        T_cam_world: AnyArray,
        size: AnyArray,
        prescription: Prescription | None = None,
        window: FlatWindow | WavyWindow | None = None,
    ) -> None:
        width, height = whole_array(size, (2,), "size").tolist()
        parts: dict[str, object] = {
            "K": kept(float_array(K, (3, 3), "K")),
            "lens": one_text(lens, "lens"),
            "dist": kept(float_array(dist, ("k",), "dist")),
            "T_cam_world": kept(float_array(T_cam_world, (4, 4), "T_cam_world")),
            "size": (width, height),
            "prescription": prescription,
            "window": window,
        }
        if window is not None and not isinstance(window, FlatWindow | WavyWindow):
            raise wrong_type(window, "a FlatWindow or a WavyWindow", "window")
        if prescription is not None:
            object_of(prescription, Prescription, "prescription")
        for name, part in parts.items():
            object.__setattr__(self, name, part)
        require_possible(self)

    def plot(self) -> "matplotlib.figure.Figure":
        """Draw how far the lens displaces its picture, in px, with the field of view's border.

        Returns
        -------
        matplotlib.figure.Figure
            To show in a notebook, or to save with ``savefig``.

        Examples
        --------
        >>> import numpy as np
        >>> from labcal import Camera
        >>> K = [[800, 0, 319.5], [0, 800, 239.5], [0, 0, 1]]
        >>> figure = Camera(K, "brown5", [-0.1, 0, 0, 0, 0], np.eye(4), (640, 480)).plot()
        >>> figure.axes[0].get_xlabel()
        'u (px)'
        """
        from labcal.cameras.camera_figure import camera_figure  # noqa: PLC0415 -- imports matplotlib

        return camera_figure(self)

    def _summary(self) -> Mapping[str, object]:
        return camera_description(self)

    @property
    def intrinsics(self) -> tuple[float, float, float, float]:
        """``fx, fy, cx, cy`` in pixels."""
        return (float(self.K[0, 0]), float(self.K[1, 1]), float(self.K[0, 2]), float(self.K[1, 2]))

    @cached_property
    def centre(self) -> Vectors3:
        """The centre of projection in the world, mm, shape (3,)."""
        return kept(inverse(self.T_cam_world)[:3, 3])

    def towards(self, p: AnyArray) -> Vectors3:
        """Return the directions (of any length) from world points, mm, shape (..., 3), to the camera."""
        if self.model.parallel:
            return np.broadcast_to(-self.T_cam_world[2, :3], np.shape(p))
        return np.asarray(self.centre - p)

    @cached_property
    def model(self) -> Lens:
        """The lens model."""
        return lens_by_name(self.lens) if self.prescription is None else PrescribedLens(self.prescription)

    @property
    def optics(self) -> Optics:
        """Lens and window, to which :attr:`parameters` belong."""
        return Optics(self.model, self.window)

    @cached_property
    def parameters(self) -> tuple[float, ...]:
        """All parameters of the camera: fx fy cx cy, then the window's and the lens model's own."""
        return (*self.intrinsics, *self._window_parameters, *self._lens_parameters)

    @cached_property
    def forward_parameters(self) -> tuple[float, ...]:
        """The leading :attr:`parameters`: all that the way from points to pixels takes."""
        return (*self.intrinsics, *self._window_parameters, *self._forward_lens_parameters)

    @property
    def reach(self) -> float:
        """Largest radius of the picture on the plane at unit focal length; of parallel rays, mm."""
        fx, fy, cx, cy = self.intrinsics
        width, height = self.size
        spare = 1.0 + (self.window.largest_px if isinstance(self.window, WavyWindow) else 0.0)
        x, y = max(cx, width - 1 - cx) + spare, max(cy, height - 1 - cy) + spare
        return float(np.hypot(x / fx, y / fy))

    def rays(self, q: AnyArray) -> Rays:
        """Return the rays of pixels, in the world.

        Parameters
        ----------
        q : array_like, shape (..., 2)
            Pixels; they may lie outside the picture.

        Returns
        -------
        Rays
            Points in mm and unit directions; NaN and not ok where the lens formula has no inverse.

        Raises
        ------
        InputError, InputTypeError
            `q` has another shape, or is not made of numbers.

        Examples
        --------
        >>> import numpy as np
        >>> from labcal import Camera
        >>> K = [[800, 0, 319.5], [0, 800, 239.5], [0, 0, 1]]
        >>> camera = Camera(K, "pinhole", [0] * 5, np.eye(4), (640, 480))
        >>> camera.rays([319.5, 239.5]).direction
        array([0., 0., 1.])
        """
        q = float_array(q, (..., 2), "q")
        with np.errstate(invalid="ignore", over="ignore", divide="ignore"):
            traced = self.optics.trace(NUMPY, self.parameters, q[..., 0], q[..., 1])
            T_world_cam = inverse(self.T_cam_world)
            origin = transform(T_world_cam, np.stack(traced.origin, axis=-1))
            direction = np.stack(traced.direction, axis=-1) @ T_world_cam[:3, :3].T
        ok = np.asarray(traced.ok & np.isfinite(direction).all(axis=-1))
        return Rays(np.where(ok[..., None], origin, np.nan), np.where(ok[..., None], direction, np.nan), ok)

    def project(self, p: AnyArray) -> Projection:
        """Return the pixels of world points.

        Parameters
        ----------
        p : array_like, shape (..., 3)
            World points, mm.

        Returns
        -------
        Projection
            Pixels, also outside the picture; NaN and not ok behind the camera (but for parallel rays, which
            determine no depth), beyond the fold of the lens model and for NaN and infinity.

        Raises
        ------
        InputError, InputTypeError
            `p` has another shape, or is not made of numbers.

        Examples
        --------
        >>> import numpy as np
        >>> from labcal import Camera
        >>> K = [[800, 0, 319.5], [0, 800, 239.5], [0, 0, 1]]
        >>> camera = Camera(K, "pinhole", [0] * 5, np.eye(4), (640, 480))
        >>> camera.project([[0, 10, 1000], [0, 10, -1000]])
        Projection(q=array([[319.5, 247.5],
               [  nan,   nan]]), ok=array([ True, False]))
        """
        p = float_array(p, (..., 3), "p")
        with np.errstate(invalid="ignore", over="ignore"):  # of infinity
            p_cam = transform(self.T_cam_world, p)
        return self.project_in_camera(p_cam)

    def project_in_camera(self, p_cam: AnyArray) -> Projection:
        """Return the pixels of points of the camera's frame, as :meth:`project` does.

        Parameters
        ----------
        p_cam : array_like, shape (..., 3)
            Points, mm.
        """
        X, Y, Z = np.moveaxis(float_array(p_cam, (..., 3), "p_cam"), -1, 0)
        with np.errstate(invalid="ignore", over="ignore", divide="ignore"):
            found = self.optics.project(NUMPY, self.forward_parameters, (X, Y, Z))
        q = np.stack([found.u, found.v], axis=-1)
        ok = np.asarray(found.ok & np.isfinite(q).all(axis=-1))
        return Projection(np.where(ok[..., None], q, np.nan), ok)

    def point_jacobian(self, p: AnyArray) -> PointJacobians:
        """Return dq / dp at world points, shape (..., 2, 3), px/mm."""
        return point_jacobian(self, float_array(p, (..., 3), "p"))

    def intrinsic_jacobian(self, p: AnyArray) -> np.ndarray:
        """Return dq / d(fx, fy, cx, cy, coefficients) at world points, shape (..., 2, 4 + coefficients)."""
        return intrinsic_jacobian(self, float_array(p, (..., 3), "p"))

    def in_picture(self, q: AnyArray) -> Mask:
        """Return whether pixels lie on the picture, which reaches half a pixel beyond the outer centres."""
        width, height = self.size
        q = float_array(q, (..., 2), "q")
        inside = np.abs(q - 0.5 * np.array([width - 1, height - 1])) <= 0.5 * np.array([width, height])
        return np.asarray(inside.all(axis=-1))

    @cached_property
    def share_without_rays(self) -> float:
        """The share of a lattice over the picture whose pixels see no direction: the lens folds there."""
        return float((~self.rays(np.stack(self.lattice(), axis=-1)).ok).mean())

    @property
    def padded_dist(self) -> tuple[float, ...]:
        """The coefficients, with zeros up to as many as any model has."""
        return (*(float(k) for k in self.dist), *(0.0,) * max(0, MOST_COEFFICIENTS - len(self.dist)))

    @cached_property
    def _window_parameters(self) -> tuple[float, ...]:
        return () if self.window is None else self.window.parameters

    @cached_property
    def _forward_lens_parameters(self) -> tuple[float, ...]:
        return self.model.forward_parameters(NUMPY, self.padded_dist)

    @cached_property
    def _lens_parameters(self) -> tuple[float, ...]:
        return self.model.parameters(NUMPY, self.padded_dist, self.reach)

    def lattice(self) -> tuple[np.ndarray, np.ndarray]:
        """Return u and v of a lattice over the picture up to its very edges."""
        u = np.linspace(-0.5, self.size[0] - 0.5, _LATTICE)
        v = np.linspace(-0.5, self.size[1] - 0.5, _LATTICE)
        across, down = np.meshgrid(u, v)
        return across.ravel(), down.ravel()
