"""Lenses that image straight lines nearly straight, in OpenCV's order of coefficients.

k1 k2 p1 p2 k3 (Brown 1966), k4 k5 k6 (the rational model, Claus and Fitzgibbon 2005), s1 s2 s3 s4 (thin
prism, Weng, Cohen and Herniou 1992), tau_x tau_y (a tilted sensor after Scheimpflug, Louhichi et al. 2007).
Field coordinates of such a lens are X/Z and Y/Z.
"""

from dataclasses import dataclass
from typing import ClassVar

import numpy as np

from labcal.cameras.dual import DualMathematics, constants
from labcal.cameras.field import Direction, FallOff, FieldPoint, SceneRay
from labcal.cameras.mathematics import Mathematics, Number
from labcal.cameras.newton import solve_two
from labcal.cameras.opencv_model import PERSPECTIVE, OpenCVModel
from labcal.cameras.radial import LENGTH as GUESS_LENGTH
from labcal.cameras.radial import field_over_image, guess, inverse_guess, positive_roots

DISTORTION = 12
"""k1 to s4; behind them stand the tilt's matrix, its inverse, the fold and the guess of the inverse."""
_TANGENTIAL, _RATIONAL, _PRISM, _TILTED = 5, 8, 12, 14
_TILT = slice(DISTORTION, DISTORTION + 9)
_UNTILT = slice(DISTORTION + 9, DISTORTION + 18)
_FOLD = DISTORTION + 18
_GUESS = slice(_FOLD + 1, _FOLD + 1 + GUESS_LENGTH)


def tilt_matrix(m: Mathematics, tau_x: Number, tau_y: Number) -> tuple[Number, ...]:
    """Return the homography of a sensor turned by tau_x about x, then by tau_y about y (rad), row by row.

    The plane of the picture is the tilted one, seen from the lens at unit distance, as in OpenCV.
    """
    cx, sx, cy, sy = m.cos(tau_x), m.sin(tau_x), m.cos(tau_y), m.sin(tau_y)
    # OpenCV's [R33 0 -R13; 0 R33 -R23; 0 0 1] R with R = R_y(tau_y) R_x(tau_x).
    r13, r23, r33 = -sy * cx, sx, cy * cx
    return (
        r33 * cy - r13 * sy, r33 * sy * sx + r13 * cy * sx, 0.0 * r33,
        -r23 * sy, r33 * cx + r23 * cy * sx, 0.0 * r33,
        sy, -cy * sx, r33,
    )  # fmt: skip


def _moved(matrix: tuple[Number, ...], x: Number, y: Number) -> tuple[Number, Number]:
    """Return a position after the homography of a tilt."""
    a, b, _, d, e, _, g, h, i = matrix  # a tilt leaves the picture's middle where it is
    w = 1.0 / (g * x + h * y + i)
    return (a * x + b * y) * w, (d * x + e * y) * w


@dataclass(frozen=True)
class Perspective:
    """A perspective lens with the first `coefficients` of OpenCV's 14 free and the rest zero."""

    name: str
    coefficients: int
    central = True
    parallel = False
    opencv: ClassVar[OpenCVModel | None] = PERSPECTIVE
    ranges = None
    fall_off = FallOff.COS4
    rectilinear = True

    @property
    def names(self) -> tuple[str, ...]:
        """The names of the coefficients: OpenCV's, in its order."""
        return PERSPECTIVE.order[: self.coefficients]

    @property
    def undistorted(self) -> tuple[float, ...]:
        """Zeros."""
        return (0.0,) * self.coefficients

    def undistorted_radius(self, angle: float) -> float:
        """Return the tangent of an angle (rad)."""
        return float(np.tan(angle))

    def formula(self, m: Mathematics, dist: tuple[Number, ...]) -> tuple[Number, ...]:
        """Return what :meth:`distort` takes: k1 to s4, and the tilt's matrix where there is one."""
        distortion = dist[:DISTORTION]
        return distortion if self.coefficients < _TILTED else (*distortion, *tilt_matrix(m, *dist[12:14]))

    def forward_parameters(self, m: Mathematics, dist: tuple[float, ...]) -> tuple[float, ...]:
        """Return all parameters but the guess's."""
        tilt = self.formula(m, dist)[_TILT] or tuple(np.eye(3).ravel())
        untilt = np.linalg.inv(np.array(tilt, dtype=np.float64).reshape(3, 3))
        return (*dist[:DISTORTION], *tilt, *untilt.ravel().tolist(), fold_radius_squared(dist))

    def parameters(self, m: Mathematics, dist: tuple[float, ...], reach: float) -> tuple[float, ...]:
        """Return all parameters of both directions; `reach` is the picture's largest radius (unit focal)."""
        forward = self.forward_parameters(m, dist)
        # The tilt, and what is not radial, reach a little farther.
        lean = float(np.abs(forward[_UNTILT][6:8]).sum())
        start = inverse_guess(
            lambda r: np.asarray(r * self._radial(m, dist, r * r)),
            float(np.sqrt(forward[_FOLD])),
            1.03 * reach * (1.0 + 2.0 * lean * reach),
        )
        return (*forward, *start)

    def distort(
        self, m: Mathematics, parameters: tuple[Number, ...], a: Number, b: Number
    ) -> tuple[Number, Number]:
        """Return the normalised image coordinates (x, y) of a field point."""
        x, y = self._distort_untilted(m, parameters, a, b)
        return (x, y) if self.coefficients < _TILTED else _moved(parameters[_TILT], x, y)

    def field_point(self, m: Mathematics, parameters: tuple[Number, ...], direction: Direction) -> FieldPoint:
        """Return the field point of a direction; not ok behind the camera and beyond the fold."""
        X, Y, Z = direction
        front = Z > 0.0
        depth = m.where(front, Z, 1.0)
        a, b = X / depth, Y / depth
        return FieldPoint(a, b, front & self.is_imaged(parameters, a, b))

    def undistort(self, m: Mathematics, parameters: tuple[Number, ...], x: Number, y: Number) -> FieldPoint:
        """Return the field point of (x, y), by Newton's method."""
        if self.coefficients == 0:
            return FieldPoint(x, y, x - x == 0.0)  # false for NaN and infinity, in any number
        if self.coefficients >= _TILTED:
            x, y = _moved(parameters[_UNTILT], x, y)
        if self.coefficients < _TANGENTIAL:
            return self._undistort_radially(m, parameters, x, y)
        # What is not radial is small, and nearly the same where the guess without it lies.
        ratio = guess(m, parameters[_GUESS], x * x + y * y)
        aside_x, aside_y = self._decentre(parameters, ratio * x, ratio * y)
        a, b = x - aside_x, y - aside_y
        ratio = guess(m, parameters[_GUESS], a * a + b * b)
        d, lifted = DualMathematics(m), constants(parameters[:DISTORTION], 2)

        def residual(a: Number, b: Number) -> tuple[Number, Number]:
            at_x, at_y = self._distort_untilted(d, lifted, a, b)
            return at_x - x, at_y - y

        found = solve_two(m, residual, ratio * a, ratio * b)
        a, b = found.a, found.b
        return FieldPoint(a, b, found.ok & self.is_imaged(parameters, a, b) & (found.determinant > 0.0))

    def _undistort_radially(
        self, m: Mathematics, parameters: tuple[Number, ...], x: Number, y: Number
    ) -> FieldPoint:
        """Return the field point of (x, y) by a lens that is the same all around."""
        lifted = constants(parameters[:DISTORTION], 1)
        found = field_over_image(
            m, lambda d, r2: self._radial(d, lifted, r2), parameters[_GUESS], x * x + y * y
        )
        a, b = found.t * x, found.t * y
        return FieldPoint(a, b, found.ok & (found.t > 0.0) & self.is_imaged(parameters, a, b))

    def is_imaged(self, parameters: tuple[Number, ...], a: Number, b: Number) -> Number:
        """Return whether a field point lies short of the fold."""
        return a * a + b * b < parameters[_FOLD]

    def chief_ray(self, m: Mathematics, _parameters: tuple[Number, ...], a: Number, b: Number) -> SceneRay:
        """Return the ray of a field point, from the lens out into the scene."""
        Z = 1.0 / m.sqrt(a * a + b * b + 1.0)
        zero = 0.0 * Z
        return SceneRay((zero, zero, zero), (a * Z, b * Z, Z), Z > 0.0)

    def _distort_untilted(
        self, m: Mathematics, parameters: tuple[Number, ...], a: Number, b: Number
    ) -> tuple[Number, Number]:
        """Return a field point after distortion, before the tilt."""
        if self.coefficients == 0:
            return a, b
        radial = self._radial(m, parameters, a * a + b * b)
        if self.coefficients < _TANGENTIAL:
            return a * radial, b * radial
        aside_x, aside_y = self._decentre(parameters, a, b)
        return a * radial + aside_x, b * radial + aside_y

    def _radial(self, m: Mathematics, parameters: tuple[Number, ...], r2: Number) -> Number:
        """Return the factor along the radius."""
        k1, k2, _, _, k3, k4, k5, k6 = parameters[:_RATIONAL]
        if self.coefficients < _TANGENTIAL:
            return m.polynomial(r2, (1.0, k1, k2))
        radial = m.polynomial(r2, (1.0, k1, k2, k3))
        if self.coefficients < _RATIONAL:
            return radial
        return radial / m.polynomial(r2, (1.0, k4, k5, k6))

    def _decentre(self, parameters: tuple[Number, ...], a: Number, b: Number) -> tuple[Number, Number]:
        """Return the displacement that is not radial: OpenCV's, with its terms gathered."""
        p1, p2, s1, s2, s3, s4 = (*parameters[2:4], *parameters[8:DISTORTION])
        r2, lean = a * a + b * b, 2.0 * (p1 * b + p2 * a)
        if self.coefficients < _PRISM:
            return a * lean + r2 * p2, b * lean + r2 * p1
        return a * lean + r2 * (p2 + s1 + r2 * s2), b * lean + r2 * (p1 + s3 + r2 * s4)


def fold_radius_squared(dist: tuple[float, ...]) -> float:
    """Return X/Z squared where the radial part stops growing, infinity where it never does.

    Beyond this radius two directions share one image, so the model is not valid there. With s = r^2 and the
    radial factor N(s) / D(s), the image radius stops growing where N D + 2 s (N' D - N D') = 0, and jumps
    where D = 0.
    """
    k1, k2, _, _, k3, k4, k5, k6 = dist[:_RATIONAL]
    N, D = np.array([1.0, k1, k2, k3]), np.array([1.0, k4, k5, k6])
    powers = np.arange(4.0)  # of s, so that powers N are the coefficients of s N'
    slope = np.convolve(N, D) + 2.0 * (np.convolve(powers * N, D) - np.convolve(N, powers * D))
    return min([*positive_roots(slope), *positive_roots(D)], default=float("inf"))
