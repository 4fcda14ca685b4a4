"""The enhanced unified lens of Khomutenko, Garcia and Martinet (2016): an ellipsoid, then a plane.

With d = sqrt(beta (X^2 + Y^2) + Z^2), X is imaged at X / (alpha d + (1 - alpha) Z). With beta = 1 it is the
unified model of Geyer and Daniilidis (2000), with alpha = 0 a pinhole. Both ways are closed formulas.
"""

from dataclasses import dataclass
from typing import ClassVar

import numpy as np

from labcal.cameras.field import FieldPoint
from labcal.cameras.mathematics import Mathematics, Number
from labcal.cameras.stereographic import StereographicField, field_limit, stereographic, unified_end

_LARGEST_ALPHA, _LARGEST_BETA = 10.0, 1e4


def enhanced_unified_end(alpha: float, beta: float) -> float:
    """Return the angle to the axis (rad) where the image radius ends or stops growing; 0 for beta <= 0.

    The ellipsoid becomes a sphere where lengths across the axis are stretched by the root of beta.
    """
    if beta <= 0.0:
        return 0.0
    seen = unified_end(alpha)
    return float(np.arctan2(np.sin(seen), np.sqrt(beta) * np.cos(seen)))


@dataclass(frozen=True)
class EnhancedUnified(StereographicField):
    """The enhanced unified lens with the coefficients alpha and beta."""

    coefficients = 2
    names = ("alpha", "beta")
    undistorted = (0.5, 1.0)
    ranges = ((-_LARGEST_ALPHA, _LARGEST_ALPHA), (1.0 / _LARGEST_BETA, _LARGEST_BETA))
    limit_at: ClassVar[int] = 2

    def undistorted_radius(self, angle: float) -> float:
        """Return twice the tangent of half an angle (rad)."""
        return float(2.0 * np.tan(0.5 * angle))

    def formula(self, _m: Mathematics, dist: tuple[Number, ...]) -> tuple[Number, ...]:
        """Return what :meth:`distort` takes: alpha and beta."""
        return dist[: self.coefficients]

    def forward_parameters(self, _m: Mathematics, dist: tuple[float, ...]) -> tuple[float, ...]:
        """Return all parameters: alpha, beta, and where the field ends."""
        alpha, beta = dist[: self.coefficients]
        return (alpha, beta, field_limit(enhanced_unified_end(alpha, beta)))

    def parameters(self, m: Mathematics, dist: tuple[float, ...], _reach: float) -> tuple[float, ...]:
        """Return the same: the way back needs no guess."""
        return self.forward_parameters(m, dist)

    def distort(
        self, m: Mathematics, parameters: tuple[Number, ...], a: Number, b: Number
    ) -> tuple[Number, Number]:
        """Return the normalised image coordinates (x, y) of a field point."""
        alpha, beta, *_ = parameters
        s = a * a + b * b
        z = 1.0 - s
        along = alpha * m.sqrt(4.0 * beta * s + z * z) + (1.0 - alpha) * z
        share = 2.0 / along
        return a * share, b * share

    def undistort(self, m: Mathematics, parameters: tuple[Number, ...], x: Number, y: Number) -> FieldPoint:
        """Return the field point of (x, y), by the closed formula."""
        alpha, beta, *_ = parameters
        r2 = beta * (x * x + y * y)
        root2 = 1.0 - (2.0 * alpha - 1.0) * r2
        z = (1.0 - alpha * alpha * r2) / (alpha * m.sqrt(m.where(root2 > 0.0, root2, 0.0)) + 1.0 - alpha)
        a, b = stereographic(m, (x, y, z))
        return FieldPoint(a, b, (root2 >= 0.0) & self.is_imaged(parameters, a, b))
