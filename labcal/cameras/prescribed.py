"""The lens model of a prescription: every ray is traced surface by surface, and none through one point.

The chief ray of a pixel passes the middle of the stop; field coordinates are its slopes there. It stays in a
plane with the axis, so that one coordinate across the axis is enough. From the stop both ways are closed
formulas: forwards through the front group into the scene, backwards through the rear group to the film. The
origin of the camera's frame is the paraxial entrance pupil.
"""

from dataclasses import dataclass
from functools import cached_property

import numpy as np

from labcal.cameras.dual import Dual, DualMathematics, constants, variables
from labcal.cameras.field import Direction, FallOff, FieldPoint, SceneRay
from labcal.cameras.mathematics import NUMPY, Mathematics, Number
from labcal.cameras.newton import solve_one
from labcal.cameras.prescription import Paraxial, Prescription, paraxial, paraxial_ray
from labcal.cameras.radial import LENGTH as GUESS_LENGTH
from labcal.cameras.radial import guess, inverse_guess
from labcal.cameras.spherical import SURFACE, AxialRay, through

_STEEPEST = 4.0
"""Slope at the stop up to which the field is searched for its end."""
_SCAN = 4001
_ON_AXIS = 1e-30
"""Squared distance from the axis below which a point lies on it."""
_FRONT_MM, _FILM_MM, _SCALE, _PUPIL, _FOLD = range(5)
_GUESS = slice(5, 5 + GUESS_LENGTH)
_SURFACES = 5 + GUESS_LENGTH


@dataclass(frozen=True)
class PrescribedLens:
    """A lens of spherical surfaces; it has no coefficients to be calibrated."""

    prescription: Prescription
    name = "prescription"
    coefficients = 0
    central = False
    parallel = False
    opencv = None
    undistorted = ()
    ranges = None
    fall_off = FallOff.TRACED
    rectilinear = True

    @property
    def names(self) -> tuple[str, ...]:
        """The names of the coefficients, of which there are none."""
        return ()

    def undistorted_radius(self, angle: float) -> float:
        """Return the tangent of an angle (rad), as near the axis."""
        return float(np.tan(angle))

    @cached_property
    def paraxial(self) -> Paraxial:
        """The lens near its axis."""
        return paraxial(self.prescription)

    def formula(self, _m: Mathematics, _dist: tuple[Number, ...]) -> tuple[Number, ...]:
        """Return all parameters but the guess's, which :meth:`distort` does not take."""
        near_axis, stop = self.paraxial, self.prescription.stop
        return (
            near_axis.entrance_pupil_mm,
            near_axis.film_mm,
            1.0 / near_axis.focal_mm,
            near_axis.pupil_slope,
            _STEEPEST,
            *(0.0,) * GUESS_LENGTH,
            *self.prescription.towards_film(stop + 1, len(self.prescription.surfaces)),
            *self.prescription.towards_scene(stop - 1),
        )

    def forward_parameters(self, m: Mathematics, dist: tuple[float, ...]) -> tuple[float, ...]:
        """Return all parameters, with zeros where the guess's are."""
        parameters = list(self.formula(m, dist))
        parameters[_FOLD] = self._field_end(tuple(parameters))
        return tuple(parameters)

    def parameters(self, m: Mathematics, dist: tuple[float, ...], reach: float) -> tuple[float, ...]:
        """Return all parameters of both directions; `reach` is the picture's largest radius (unit focal)."""
        parameters = list(self.forward_parameters(m, dist))
        parameters[_GUESS] = inverse_guess(
            lambda t: np.asarray(self._image_radius(NUMPY, tuple(parameters), t)), parameters[_FOLD], reach
        )
        return tuple(parameters)

    def distort(
        self, m: Mathematics, parameters: tuple[Number, ...], a: Number, b: Number
    ) -> tuple[Number, Number]:
        """Return where a field point is imaged: the place on the film over the focal length."""
        slope = _radius(m, a, b)
        stretch = self._image_radius(m, parameters, slope) / slope
        return a * stretch, b * stretch

    def field_point(self, m: Mathematics, parameters: tuple[Number, ...], direction: Direction) -> FieldPoint:
        """Return roughly the field point of a point far away in a direction; not ok behind the camera."""
        X, Y, Z = direction
        front = Z > 0.0
        depth = m.where(front, Z, 1.0) * parameters[_PUPIL]
        return FieldPoint(X / depth, Y / depth, front)

    def undistort(self, m: Mathematics, parameters: tuple[Number, ...], x: Number, y: Number) -> FieldPoint:
        """Return the field point of (x, y), by Newton's method on its distance.

        The guess is so close that its own slope does for every step, and no slope is traced.
        """
        radius = _radius(m, x, y)
        (outwards,) = variables(radius)
        start = outwards * guess(DualMathematics(m), constants(parameters[_GUESS], 1), outwards * outwards)
        steep = 1.0 / start.slopes[0]

        def residual(slope: Dual) -> Dual:
            return Dual(self._image_radius(m, parameters, slope.value) - radius, (steep,))

        found = solve_one(m, residual, start.value)
        ratio = found.t / radius
        a, b = x * ratio, y * ratio
        return FieldPoint(a, b, found.ok & self.is_imaged(parameters, a, b))

    def is_imaged(self, parameters: tuple[Number, ...], a: Number, b: Number) -> Number:
        """Return whether the chief ray of a field point passes every surface."""
        return a * a + b * b < parameters[_FOLD] * parameters[_FOLD]

    def chief_ray(self, m: Mathematics, parameters: tuple[Number, ...], a: Number, b: Number) -> SceneRay:
        """Return the ray of a field point, from the front surface out into the scene."""
        slope = _radius(m, a, b)
        ray = through(m, parameters[_SURFACES + SURFACE * self._behind :], _from_stop(m, slope)).ray
        share = 1.0 / slope
        x, dx = ray.across[0] * share, ray.slant[0] * share
        return SceneRay((a * x, b * x, parameters[_FRONT_MM] + ray.s), (a * dx, b * dx, ray.ds), ray.ds > 0.0)

    @cached_property
    def exit_pupil(self) -> tuple[float, float]:
        """Place of the paraxial exit pupil behind the last vertex (mm), and its size over the stop's."""
        rear = self.prescription.towards_film(self.prescription.stop + 1, len(self.prescription.surfaces))
        height, slope = paraxial_ray(rear, 0.0, 1.0)
        return -height / slope, 1.0 / slope

    @property
    def _behind(self) -> int:
        """Number of surfaces behind the stop."""
        return len(self.prescription.surfaces) - 1 - self.prescription.stop

    def _image_radius(self, m: Mathematics, parameters: tuple[Number, ...], slope: Number) -> Number:
        """Return how far from the axis the chief ray of a slope at the stop meets the film (unit focal)."""
        rear = parameters[_SURFACES : _SURFACES + SURFACE * self._behind]
        ray = through(m, rear, _from_stop(m, slope)).ray
        along = (parameters[_FILM_MM] - ray.s) / ray.ds
        return m.fma(along, ray.slant[0], ray.across[0]) * parameters[_SCALE]

    def _field_end(self, parameters: tuple[float, ...]) -> float:
        """Return the slope at the stop from which on the chief ray is blocked or turns back."""
        slope = np.linspace(0.0, _STEEPEST, _SCAN)
        split = _SURFACES + SURFACE * self._behind
        with np.errstate(invalid="ignore"):
            rear = through(NUMPY, parameters[_SURFACES:split], _from_stop(NUMPY, slope))
            front = through(NUMPY, parameters[split:], _from_stop(NUMPY, slope))
            radius = self._image_radius(NUMPY, parameters, slope)
            passes = np.all([spare >= 0.0 for spare in (*rear.spare, *front.spare)], axis=0)
            outwards = front.ray.slant[0] / front.ray.ds
            grows = np.append(True, (np.diff(radius) > 0.0) & (np.diff(outwards) > 0.0))
        blocked = np.flatnonzero(~(passes & grows & (front.ray.ds > 0.0)))
        return float(slope[blocked[0] - 1]) if len(blocked) else _STEEPEST


def _radius(m: Mathematics, x: Number, y: Number) -> Number:
    """Return the distance from the axis, on it a very small one by which may be divided."""
    return m.sqrt(m.fma(x, x, m.fma(y, y, _ON_AXIS)))


def _from_stop(m: Mathematics, slope: Number) -> AxialRay:
    """Return the ray that leaves the middle of the stop with a slope."""
    ds = 1.0 / m.sqrt(m.fma(slope, slope, 1.0))
    zero = 0.0 * ds
    return AxialRay((zero,), zero, (slope * ds,), ds)
