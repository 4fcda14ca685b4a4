"""The double-sphere lens of Usenko, Demmel and Cremers (2018): two unit spheres, then a plane.

A direction is projected onto a unit sphere, from there onto another one that is shifted by xi along the axis,
and from there onto the picture by a pinhole that is shifted by alpha / (1 - alpha). With d the length of
(X, Y, Z) and e that of (X, Y, Z + xi d), X is imaged at X / (alpha e + (1 - alpha) (Z + xi d)). Both ways
are closed formulas.
"""

from dataclasses import dataclass
from typing import ClassVar

import numpy as np

from labcal.cameras.field import FieldPoint
from labcal.cameras.mathematics import NUMPY, Mathematics, Number
from labcal.cameras.stereographic import StereographicField, field_limit, stereographic, unified_end

_LARGEST_ALPHA, _LARGEST_XI = 10.0, 10.0


def double_sphere_end(xi: float, alpha: float) -> float:
    """Return the angle to the axis (rad) where the image radius ends or stops growing; 0 for xi <= -1.

    The angle t behind the first sphere belongs to t + asin(xi sin t) in the scene. Where xi exceeds 1 the
    first sphere itself folds, at the cosine -1 / xi.
    """
    if xi <= -1.0:
        return 0.0
    seen = unified_end(alpha)
    if xi > 1.0 and seen >= np.arcsin(1.0 / xi):
        return float(np.arccos(-1.0 / xi))
    return float(seen + np.arcsin(xi * np.sin(seen)))


@dataclass(frozen=True)
class DoubleSphere(StereographicField):
    """The double-sphere lens with the coefficients xi and alpha."""

    coefficients = 2
    names = ("xi", "alpha")
    undistorted = (-0.2, 0.5)
    """With alpha = 0.5 all directions are imaged; xi is that of the fisheyes that the paper calibrates. Dots
    that end short of the picture's rim are explained by some xi of +0.5 nearly as well, which is where
    estimates end that begin with xi = 0."""
    ranges = ((-1.0, _LARGEST_XI), (-_LARGEST_ALPHA, _LARGEST_ALPHA))
    limit_at: ClassVar[int] = 2

    def undistorted_radius(self, angle: float) -> float:
        """Return the image radius of an angle (rad)."""
        radius, _ = self.distort(NUMPY, self.undistorted, float(np.tan(0.5 * angle)), 0.0)
        return float(radius)

    def formula(self, _m: Mathematics, dist: tuple[Number, ...]) -> tuple[Number, ...]:
        """Return what :meth:`distort` takes: xi and alpha."""
        return dist[: self.coefficients]

    def forward_parameters(self, _m: Mathematics, dist: tuple[float, ...]) -> tuple[float, ...]:
        """Return all parameters: xi, alpha, and where the field ends."""
        xi, alpha = dist[: self.coefficients]
        return (xi, alpha, field_limit(double_sphere_end(xi, alpha)))

    def parameters(self, m: Mathematics, dist: tuple[float, ...], _reach: float) -> tuple[float, ...]:
        """Return the same: the way back needs no guess."""
        return self.forward_parameters(m, dist)

    def distort(
        self, m: Mathematics, parameters: tuple[Number, ...], a: Number, b: Number
    ) -> tuple[Number, Number]:
        """Return the normalised image coordinates (x, y) of a field point."""
        xi, alpha, *_ = parameters
        s = a * a + b * b
        z = (1.0 - s) + xi * (1.0 + s)
        along = alpha * m.sqrt(4.0 * s + z * z) + (1.0 - alpha) * z
        share = 2.0 / along
        return a * share, b * share

    def undistort(self, m: Mathematics, parameters: tuple[Number, ...], x: Number, y: Number) -> FieldPoint:
        """Return the field point of (x, y), by the closed formula."""
        xi, alpha, *_ = parameters
        r2 = x * x + y * y
        root2 = 1.0 - (2.0 * alpha - 1.0) * r2
        z = (1.0 - alpha * alpha * r2) / (alpha * m.sqrt(m.where(root2 > 0.0, root2, 0.0)) + 1.0 - alpha)
        back2 = z * z + (1.0 - xi * xi) * r2
        stretch = (z * xi + m.sqrt(m.where(back2 > 0.0, back2, 0.0))) / (z * z + r2)
        a, b = stereographic(m, (stretch * x, stretch * y, stretch * z - xi))
        return FieldPoint(a, b, (root2 >= 0.0) & (back2 >= 0.0) & self.is_imaged(parameters, a, b))
