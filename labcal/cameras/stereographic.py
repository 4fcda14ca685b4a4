"""Field coordinates for lenses that see more than 180 degrees by closed formulas: the stereographic ones.

A direction at the angle theta from the axis has the field radius tan(theta / 2), so that (X, Y, Z) over its
length is (2 a, 2 b, 1 - s) / (1 + s) with s = a^2 + b^2. No angle has to be computed in either way, and only
the direction straight backwards has no field point.
"""

import math
from dataclasses import dataclass
from typing import ClassVar

import numpy as np

from labcal.cameras.field import Direction, FallOff, FieldPoint, SceneRay
from labcal.cameras.mathematics import Mathematics, Number


def field_limit(angle: float) -> float:
    """Return the squared field radius of an angle (rad) to the axis; all directions for pi and more."""
    return math.tan(0.5 * angle) ** 2 if angle < math.pi else math.inf


def stereographic(m: Mathematics, direction: Direction) -> tuple[Number, Number]:
    """Return the field point of a direction of any length; no number for the one straight backwards."""
    X, Y, Z = direction
    share = 1.0 / (m.sqrt(X * X + Y * Y + Z * Z) + Z)
    return X * share, Y * share


@dataclass(frozen=True)
class StereographicField:
    """Members common to lenses with these field coordinates; the projection is their own."""

    name: str
    central = True
    parallel = False
    opencv = None
    fall_off = FallOff.EVEN
    rectilinear = False
    limit_at: ClassVar[int]
    """Place, among the lens's parameters, of the squared field radius up to which it images."""

    def field_point(self, m: Mathematics, parameters: tuple[Number, ...], direction: Direction) -> FieldPoint:
        """Return the field point of a direction; not ok where the lens images nothing."""
        a, b = stereographic(m, direction)
        return FieldPoint(a, b, self.is_imaged(parameters, a, b))

    def is_imaged(self, parameters: tuple[Number, ...], a: Number, b: Number) -> Number:
        """Return whether the lens images a field point."""
        return a * a + b * b < parameters[self.limit_at]

    def chief_ray(self, _m: Mathematics, _parameters: tuple[Number, ...], a: Number, b: Number) -> SceneRay:
        """Return the ray of a field point, from the lens out into the scene."""
        s = a * a + b * b
        share = 1.0 / (1.0 + s)
        zero = 0.0 * s
        direction = (2.0 * a * share, 2.0 * b * share, (1.0 - s) * share)
        return SceneRay((zero, zero, zero), direction, s >= 0.0)


def unified_end(alpha: float) -> float:
    """Return the angle (rad) to the axis up to which a plane sees a sphere, of the unified projection.

    The unified projection is r / (alpha d + (1 - alpha) z) with d the length of (r, z). Up to alpha = 1/2 it
    ends where the denominator vanishes, beyond where the image turns back.
    """
    w = alpha / (1.0 - alpha) if alpha <= 0.5 else (1.0 - alpha) / alpha  # noqa: PLR2004 -- a half
    return float(np.arccos(-w))
