"""The fisheye lens of Kannala and Brandt (2006) as OpenCV has it: theta_d = theta (1 + k1 theta^2 + ...).

Field coordinates are the angle to the axis, theta, split along x and y, so that more than 180 degrees are as
good as any.
"""

from dataclasses import dataclass

import numpy as np

from labcal.cameras.dual import constants
from labcal.cameras.field import Direction, FallOff, FieldPoint, SceneRay
from labcal.cameras.mathematics import Mathematics, Number, cosine_and_sinc
from labcal.cameras.opencv_model import FISHEYE
from labcal.cameras.radial import field_over_image, inverse_guess, positive_roots

_POWERS = 4
_FOLD = _POWERS
_GUESS = slice(_FOLD + 1, None)
_ON_AXIS = 1e-16
"""Squared radius below which a direction counts as the axis itself."""


def _stretch(m: Mathematics, parameters: tuple[Number, ...], theta2: Number) -> Number:
    """Return theta_d / theta."""
    return m.polynomial(theta2, (1.0, *parameters[:_POWERS]))


def fold_angle(dist: tuple[float, ...]) -> float:
    """Return the angle to the axis (rad) where the image radius stops growing, at most pi."""
    k1, k2, k3, k4 = dist[:_POWERS]
    slope = (1.0, 3.0 * k1, 5.0 * k2, 7.0 * k3, 9.0 * k4)
    return min([*(float(np.sqrt(s)) for s in positive_roots(slope)), float(np.pi)])


@dataclass(frozen=True)
class KannalaBrandt:
    """The equidistant fisheye with four coefficients k1 to k4 (a fifth place of `dist` is zero)."""

    name: str
    coefficients = _POWERS
    central = True
    parallel = False
    names = FISHEYE.order
    opencv = FISHEYE
    undistorted = (0.0,) * _POWERS
    ranges = None
    fall_off = FallOff.EVEN
    rectilinear = False

    def undistorted_radius(self, angle: float) -> float:
        """Return the angle (rad) itself."""
        return angle

    def formula(self, _m: Mathematics, dist: tuple[Number, ...]) -> tuple[Number, ...]:
        """Return what :meth:`distort` takes: k1 to k4."""
        return dist[:_POWERS]

    def forward_parameters(self, _m: Mathematics, dist: tuple[float, ...]) -> tuple[float, ...]:
        """Return all parameters but the guess's."""
        return (*dist[:_POWERS], fold_angle(dist))

    def parameters(self, m: Mathematics, dist: tuple[float, ...], reach: float) -> tuple[float, ...]:
        """Return all parameters of both directions; `reach` is the picture's largest radius (unit focal)."""
        forward = self.forward_parameters(m, dist)
        start = inverse_guess(lambda t: np.asarray(t * _stretch(m, dist, t * t)), forward[_FOLD], reach)
        return (*forward, *start)

    def distort(
        self, m: Mathematics, parameters: tuple[Number, ...], a: Number, b: Number
    ) -> tuple[Number, Number]:
        """Return the normalised image coordinates (x, y) of a field point."""
        stretch = _stretch(m, parameters, a * a + b * b)
        return a * stretch, b * stretch

    def field_point(self, m: Mathematics, parameters: tuple[Number, ...], direction: Direction) -> FieldPoint:
        """Return the field point of a direction; not ok beyond the fold."""
        X, Y, Z = direction
        across = X * X + Y * Y
        on_axis = across < _ON_AXIS * (Z * Z)
        radius = m.sqrt(m.where(on_axis, 1.0 + 0.0 * across, across))
        theta = m.atan2(radius, Z)
        front = Z > 0.0
        ratio = m.where(on_axis, 1.0 / m.where(front, Z, 1.0), theta / radius)
        ok = m.where(on_axis, front, theta < parameters[_FOLD])
        return FieldPoint(X * ratio, Y * ratio, ok)

    def undistort(self, m: Mathematics, parameters: tuple[Number, ...], x: Number, y: Number) -> FieldPoint:
        """Return the field point of (x, y), by Newton's method."""
        r2 = x * x + y * y
        lifted = constants(parameters[:_POWERS], 1)
        found = field_over_image(m, lambda d, theta2: _stretch(d, lifted, theta2), parameters[_GUESS], r2)
        a, b = x * found.t, y * found.t
        return FieldPoint(a, b, found.ok & (found.t > 0.0) & self.is_imaged(parameters, a, b))

    def is_imaged(self, parameters: tuple[Number, ...], a: Number, b: Number) -> Number:
        """Return whether a field point lies short of the fold."""
        return a * a + b * b < parameters[_FOLD] * parameters[_FOLD]

    def chief_ray(self, m: Mathematics, _parameters: tuple[Number, ...], a: Number, b: Number) -> SceneRay:
        """Return the ray of a field point, from the lens out into the scene."""
        theta2 = a * a + b * b
        cosine, sinc = cosine_and_sinc(m, theta2)
        zero = 0.0 * theta2
        return SceneRay((zero, zero, zero), (a * sinc, b * sinc, cosine), theta2 >= 0.0)
