"""The omnidirectional lens of Mei and Rives (2007): a unit sphere, a plane, and radial-tangential distortion.

A direction is projected onto a unit sphere and from there onto a plane through a point that lies xi behind
the sphere's middle: with d the length of (X, Y, Z), X falls on x = X / (Z + xi d). There Brown's k1 k2 p1 p2
displace it. The focal length belongs to this plane, so that in the middle of the picture a radian is
f / (1 + xi) pixels.
"""

from dataclasses import dataclass
from typing import ClassVar

import numpy as np

from labcal.bounds import MOST_DISTORTION
from labcal.cameras.field import FieldPoint
from labcal.cameras.mathematics import Mathematics, Number
from labcal.cameras.perspective import DISTORTION, Perspective
from labcal.cameras.stereographic import StereographicField, field_limit, stereographic, unified_end

_PLANE = Perspective("radial-tangential", 5)
"""Distortion on the plane: Brown's with k3 = 0."""
_OWN = slice(1, 1 + DISTORTION)
"""Of `dist`, padded with zeros: the plane's coefficients, behind xi."""
_LIMIT = 32
_LARGEST_XI = 1e4


def plane_end(xi: float, radius: float) -> float:
    """Return the angle to the axis (rad) that falls on a radius of the plane, or at which it ends before.

    Up to xi = 1 the plane ends where the denominator vanishes, beyond where the radius turns back.
    """
    if xi <= -1.0:
        return 0.0
    seen = unified_end(xi / (1.0 + xi))
    if not np.isfinite(radius) or radius * np.sqrt(max(xi * xi - 1.0, 0.0)) >= 1.0:
        return seen
    # r = sin t / (cos t + xi), so that sin (t - u) = xi sin u with tan u = r.
    beside = np.arctan(radius)
    return min(seen, float(beside + np.arcsin(xi * np.sin(beside))))


@dataclass(frozen=True)
class Omnidirectional(StereographicField):
    """The omnidirectional lens with xi and the distortion k1, k2, p1 and p2."""

    coefficients = 5
    names = ("xi", "k1", "k2", "p1", "p2")
    undistorted = (1.0, 0.0, 0.0, 0.0, 0.0)
    ranges = ((-1.0, _LARGEST_XI), *((-MOST_DISTORTION, MOST_DISTORTION),) * 4)
    limit_at: ClassVar[int] = _LIMIT

    def undistorted_radius(self, angle: float) -> float:
        """Return the tangent of half an angle (rad)."""
        return float(np.tan(0.5 * angle))

    def formula(self, m: Mathematics, dist: tuple[Number, ...]) -> tuple[Number, ...]:
        """Return what :meth:`distort` takes: xi and the plane's."""
        return (dist[0], *_PLANE.formula(m, dist[_OWN]))

    def forward_parameters(self, m: Mathematics, dist: tuple[float, ...]) -> tuple[float, ...]:
        """Return xi, all parameters of the plane but the guess's, and where the field ends."""
        plane = _PLANE.forward_parameters(m, dist[_OWN])
        fold = float(np.sqrt(plane[-1]))
        return (dist[0], *plane, field_limit(plane_end(dist[0], fold)))

    def parameters(self, m: Mathematics, dist: tuple[float, ...], reach: float) -> tuple[float, ...]:
        """Return the same and the plane's guess; `reach` is the picture's largest radius (unit focal)."""
        forward = self.forward_parameters(m, dist)
        return (*forward, *_PLANE.parameters(m, dist[_OWN], reach)[_LIMIT - 1 :])

    def distort(
        self, m: Mathematics, parameters: tuple[Number, ...], a: Number, b: Number
    ) -> tuple[Number, Number]:
        """Return the normalised image coordinates (x, y) of a field point."""
        s = a * a + b * b
        share = 2.0 / ((1.0 - s) + parameters[0] * (1.0 + s))
        return _PLANE.distort(m, parameters[1:], a * share, b * share)

    def undistort(self, m: Mathematics, parameters: tuple[Number, ...], x: Number, y: Number) -> FieldPoint:
        """Return the field point of (x, y): the plane's by Newton, the sphere's closed."""
        plane = _PLANE.undistort(m, (*parameters[1:_LIMIT], *parameters[_LIMIT + 1 :]), x, y)
        xi, x, y = parameters[0], plane.a, plane.b
        r2 = x * x + y * y
        root2 = 1.0 + (1.0 - xi * xi) * r2
        stretch = (xi + m.sqrt(m.where(root2 > 0.0, root2, 0.0))) / (1.0 + r2)
        a, b = stereographic(m, (stretch * x, stretch * y, stretch - xi))
        return FieldPoint(a, b, plane.ok & (root2 >= 0.0) & self.is_imaged(parameters, a, b))
