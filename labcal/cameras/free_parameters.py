"""The parameters of a camera that a calibration may find: intrinsics, lens coefficients, a window's place."""

from dataclasses import dataclass, replace

import numpy as np
from jaxtyping import Float64

from labcal.arrays import Vectors3
from labcal.cameras.camera import Camera
from labcal.cameras.derivatives import POINT, ProjectionDerivatives, has_field, projection_derivatives
from labcal.cameras.dual import Dual, DualMathematics, constants, variables
from labcal.cameras.jacobians import dual_parameters, slopes_of
from labcal.cameras.lens import LENGTH
from labcal.cameras.mathematics import NUMPY
from labcal.cameras.optics import INTRINSICS
from labcal.cameras.window import FlatWindow


@dataclass(frozen=True)
class FreeParameters:
    """The free parameters of a camera.

    Of a lens formula fx fy cx cy and all coefficients, without cx and cy where its rays are parallel; of a
    prescription, whose glass is known, f cx cy. Of a flat window its place: both tilts and the distance; of
    an interface also the refractive index behind it. A wavy window is known or not there.
    """

    camera: Camera

    @property
    def count(self) -> int:
        """Number of free parameters."""
        return len(self.values)

    @property
    def coefficients(self) -> slice:
        """Places of the lens's coefficients."""
        if self._prescribed:
            return slice(INTRINSICS - 1, INTRINSICS - 1)
        first = len(self._intrinsics)
        return slice(first, first + self.camera.model.coefficients)

    @property
    def values(self) -> Float64[np.ndarray, " free"]:
        """The parameters: intrinsics (px), coefficients, window."""
        camera = self.camera
        coefficients = camera.padded_dist[: camera.model.coefficients]
        return np.array([*self._intrinsics, *coefficients, *self._of_window])

    @property
    def deviations(self) -> Float64[np.ndarray, " free"]:
        """The parameters; of the lens's coefficients, how far they are from those of no distortion."""
        found = self.values
        if not self._prescribed:
            found[self.coefficients] -= self.camera.model.undistorted
        return found

    def moved(self, step: Float64[np.ndarray, " free"]) -> Camera:
        """Return the camera with the step added to its parameters.

        Raises
        ------
        InputError
            There is no such camera.
        ValueError
            There is no such window (pydantic's).
        """
        values, camera = self.values + step, self.camera
        first = values[0]
        fx, fy, cx, cy = (first, *values[:3]) if self._prescribed else values[:INTRINSICS]
        if camera.model.parallel:
            cx, cy = camera.intrinsics[2:]
        dist = camera.dist
        if not self._prescribed:
            dist = np.zeros(max(LENGTH, len(camera.dist)))
            dist[: camera.model.coefficients] = values[self.coefficients]
        window = camera.window
        if isinstance(window, FlatWindow):
            window = window.moved(tuple(values[-len(self._of_window) :].tolist()))
        K = np.array([[fx, 0.0, cx], [0.0, fy, cy], [0.0, 0.0, 1.0]])
        return replace(camera, K=K, dist=dist, window=window)

    def imaged(self, p_cam: Vectors3) -> ProjectionDerivatives:
        """Return images of points of the camera's frame, with derivatives by points and free parameters.

        Parameters
        ----------
        p_cam : ndarray, shape (n, 3)
            Millimetres.
        """
        camera, m = self.camera, DualMathematics(NUMPY)
        if has_field(camera) and not self._prescribed:
            seen = projection_derivatives(camera, p_cam)
            if not camera.model.parallel:
                return seen
            return replace(seen, by_camera=np.delete(seen.by_camera, (2, 3), axis=2))
        varied = variables(*np.moveaxis(p_cam, -1, 0), *self.values)
        p, free = varied[:POINT], varied[POINT:]
        with np.errstate(invalid="ignore", over="ignore", divide="ignore"):
            found = camera.optics.project(m, self._dual_parameters(m, free), (p[0], p[1], p[2]))
        J = slopes_of(found.u.slopes, found.v.slopes, p_cam.shape[:-1])
        q = np.stack(np.broadcast_arrays(found.u.value, found.v.value), axis=-1)
        return ProjectionDerivatives(q, np.asarray(found.ok), J[..., :POINT], J[..., POINT:])

    def _dual_parameters(self, m: DualMathematics, free: tuple[Dual, ...]) -> tuple[Dual, ...]:
        """Return ``Camera.forward_parameters`` with the free ones varying."""
        camera = self.camera
        intrinsics = (free[0], *free[:3]) if self._prescribed else free[:INTRINSICS]
        if camera.model.parallel:
            intrinsics = (*free[:2], *constants(camera.intrinsics[2:], POINT + self.count))
        rest = constants(camera.padded_dist[camera.model.coefficients :], POINT + self.count)
        parameters = dual_parameters(camera, m, intrinsics, (*free[self.coefficients], *rest))
        if not isinstance(camera.window, FlatWindow):
            return parameters
        glass = camera.window.formula(m, free[-len(self._of_window) :])
        return (*intrinsics, *glass, *parameters[camera.optics.lens_at :])

    @property
    def _intrinsics(self) -> tuple[float, ...]:
        """The free ones of fx fy cx cy."""
        if self.camera.model.parallel:
            return self.camera.intrinsics[:2]
        return self.camera.intrinsics[1:] if self._prescribed else self.camera.intrinsics

    @property
    def _of_window(self) -> tuple[float, ...]:
        """The free ones of a flat window."""
        return self.camera.window.free if isinstance(self.camera.window, FlatWindow) else ()

    @property
    def _prescribed(self) -> bool:
        return self.camera.prescription is not None
