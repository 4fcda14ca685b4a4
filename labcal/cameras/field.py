"""Field points of a lens and its rays in the scene, in terms of which all lens models are written.

A lens maps a *field point* (a, b), two coordinates of its own that grow from its axis, to the picture and to
a ray in the scene. Both maps are closed formulas; the ways back are found by Newton's method.
"""

from dataclasses import dataclass
from enum import Enum

from labcal.cameras.mathematics import Number

Direction = tuple[Number, Number, Number]
"""(X, Y, Z) in the camera's frame: x right, y down, z forward."""


@dataclass(frozen=True)
class FieldPoint:
    """A field point in the caller's kind of number, and whether the lens has one there."""

    a: Number
    b: Number
    ok: Number


@dataclass(frozen=True)
class SceneRay:
    """A ray in the camera's frame: a point on it in mm, its unit direction outwards, and whether it is."""

    origin: Direction
    direction: Direction
    ok: Number


class FallOff(Enum):
    """Fall-off of a lens's light towards the rim of the picture."""

    COS4 = "cos^4 of the angle to the axis"
    EVEN = "not at all"
    TRACED = "as traced through its stop"
