"""The lens model of a prescription: every ray is traced surface by surface, and none through one point.

The chief ray of a pixel passes the middle of the stop; field coordinates are its slopes there. From the stop
both ways are closed formulas: forwards through the front group into the scene, backwards through the rear
group to the film. The origin of the camera's frame is the paraxial entrance pupil.
"""

from dataclasses import dataclass
from functools import cached_property

import numpy as np

from labcal.cameras.dual import DualMathematics, constants
from labcal.cameras.field import Direction, FieldPoint, SceneRay
from labcal.cameras.mathematics import NUMPY, Mathematics, Number
from labcal.cameras.newton import solve_two
from labcal.cameras.prescription import Paraxial, Prescription, paraxial, paraxial_ray
from labcal.cameras.radial import LENGTH as GUESS_LENGTH
from labcal.cameras.radial import guess, inverse_guess
from labcal.cameras.spherical import SURFACE, SkewRay, through

_STEEPEST = 4.0
"""Slope at the stop up to which the field is searched for its end."""
_SCAN = 4001
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

    @cached_property
    def paraxial(self) -> Paraxial:
        """The lens near its axis."""
        return paraxial(self.prescription)

    def formula(self, _m: Mathematics, _dist: tuple[Number, ...]) -> tuple[Number, ...]:
        """Return all numbers but the guess's, which :meth:`image` does not take."""
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

    def numbers(self, m: Mathematics, dist: tuple[float, ...], reach: float) -> tuple[float, ...]:
        """Return all numbers of both directions; `reach` is the picture's largest radius (unit focal)."""
        numbers = list(self.formula(m, dist))
        numbers[_FOLD] = self._field_end(tuple(numbers))
        numbers[_GUESS] = inverse_guess(
            lambda t: np.asarray(self.image(NUMPY, tuple(numbers), t, 0.0 * t)[0]), numbers[_FOLD], reach
        )
        return tuple(numbers)

    def image(
        self, m: Mathematics, numbers: tuple[Number, ...], a: Number, b: Number
    ) -> tuple[Number, Number]:
        """Return where a field point is imaged: the place on the film over the focal length."""
        rear = numbers[_SURFACES : _SURFACES + SURFACE * self._behind]
        ray = through(m, rear, _from_stop(m, -a, -b)).ray
        along = (numbers[_FILM_MM] - ray.s) / ray.ds
        return -(ray.x + along * ray.dx) * numbers[_SCALE], -(ray.y + along * ray.dy) * numbers[_SCALE]

    def field(self, m: Mathematics, numbers: tuple[Number, ...], direction: Direction) -> FieldPoint:
        """Return roughly the field point of a point far away in a direction; not ok behind the camera."""
        X, Y, Z = direction
        front = Z > 0.0
        depth = m.where(front, Z, 1.0) * numbers[_PUPIL]
        return FieldPoint(X / depth, Y / depth, front)

    def field_at(self, m: Mathematics, numbers: tuple[Number, ...], x: Number, y: Number) -> FieldPoint:
        """Return the field point that is imaged at (x, y), by Newton's method."""
        d, lifted = DualMathematics(m), constants(numbers, 2)
        ratio = guess(m, numbers[_GUESS], x * x + y * y)

        def miss(a: Number, b: Number) -> tuple[Number, Number]:
            at_x, at_y = self.image(d, lifted, a, b)
            return at_x - x, at_y - y

        found = solve_two(m, miss, ratio * x, ratio * y)
        return FieldPoint(found.a, found.b, found.ok & self.in_field(numbers, found.a, found.b))

    def in_field(self, numbers: tuple[Number, ...], a: Number, b: Number) -> Number:
        """Return whether the chief ray of a field point passes every surface."""
        return a * a + b * b < numbers[_FOLD] * numbers[_FOLD]

    def ray(self, m: Mathematics, numbers: tuple[Number, ...], a: Number, b: Number) -> SceneRay:
        """Return the ray of a field point, from the front surface out into the scene."""
        ray = through(m, numbers[_SURFACES + SURFACE * self._behind :], _from_stop(m, a, b)).ray
        origin = (ray.x, ray.y, numbers[_FRONT_MM] + ray.s)
        return SceneRay(origin, (ray.dx, ray.dy, ray.ds), ray.ds > 0.0)

    @cached_property
    def exit_pupil(self) -> tuple[float, float]:
        """Place of the paraxial exit pupil behind the last vertex (mm), and its size over the stop's."""
        rear = self.prescription.towards_film(self.prescription.stop + 1, len(self.prescription.surfaces))
        height, slope = paraxial_ray(rear, 0.0, 1.0)
        return -height / slope, 1.0 / slope

    @property
    def _behind(self) -> int:
        """How many surfaces stand behind the stop."""
        return len(self.prescription.surfaces) - 1 - self.prescription.stop

    def _field_end(self, numbers: tuple[float, ...]) -> float:
        """Return the slope at the stop from which on the chief ray is blocked or turns back."""
        slope = np.linspace(0.0, _STEEPEST, _SCAN)
        zero = 0.0 * slope
        split = _SURFACES + SURFACE * self._behind
        with np.errstate(invalid="ignore"):
            rear = through(NUMPY, numbers[_SURFACES:split], _from_stop(NUMPY, -slope, zero))
            front = through(NUMPY, numbers[split:], _from_stop(NUMPY, slope, zero))
            radius = self.image(NUMPY, numbers, slope, zero)[0]
            passes = np.all([spare >= 0.0 for spare in (*rear.spare, *front.spare)], axis=0)
            outwards = front.ray.dx / front.ray.ds
            grows = np.append(True, (np.diff(radius) > 0.0) & (np.diff(outwards) > 0.0))
        blocked = np.flatnonzero(~(passes & grows & (front.ray.ds > 0.0)))
        return float(slope[blocked[0] - 1]) if len(blocked) else _STEEPEST


def _from_stop(m: Mathematics, a: Number, b: Number) -> SkewRay:
    """Return the ray that leaves the middle of the stop with slopes a and b."""
    ds = 1.0 / m.sqrt(a * a + b * b + 1.0)
    zero = 0.0 * ds
    return SkewRay(zero, zero, zero, a * ds, b * ds, ds)
