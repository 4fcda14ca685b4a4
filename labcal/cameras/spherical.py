"""A ray through spherical surfaces, one after the other: the exact skew trace (Welford 1986, chapter 4).

Coordinates x and y lie across the lens's axis, s along it in the direction of travel. A surface is four
numbers: the gap to it from the vertex before, its curvature (positive with its centre farther along), the
ratio of the refractive indices before and behind, and its clear radius squared.
"""

from dataclasses import dataclass

from labcal.cameras.mathematics import Mathematics, Number

SURFACE = 4
"""Numbers of a surface: gap in mm, curvature in 1/mm, index ratio, clear radius squared in mm^2."""


@dataclass(frozen=True)
class SkewRay:
    """A point, with s counted from the vertex of the surface passed last, and a unit direction."""

    x: Number
    y: Number
    s: Number
    dx: Number
    dy: Number
    ds: Number


@dataclass(frozen=True)
class Passage:
    """A ray behind surfaces, and by how much it stayed within the clear radius of each, in mm^2."""

    ray: SkewRay
    spare: tuple[Number, ...]


def through(m: Mathematics, surfaces: tuple[Number, ...], ray: SkewRay) -> Passage:
    """Follow a ray through surfaces.

    Parameters
    ----------
    m : Mathematics
    surfaces : tuple of number
        :data:`SURFACE` numbers each, in the order of travel.
    ray : SkewRay
        With s counted from the point from which the first gap counts.

    Returns
    -------
    Passage
        NaN where a surface is missed or light is totally reflected.
    """
    x, y, s, dx, dy, ds = ray.x, ray.y, ray.s, ray.dx, ray.dy, ray.ds
    spare = []
    for first in range(0, len(surfaces), SURFACE):
        gap, curvature, ratio, clear2 = surfaces[first : first + SURFACE]
        s = s - gap
        e = curvature * (x * x + y * y + s * s) - 2.0 * s
        f = ds - curvature * (x * dx + y * dy + s * ds)
        cosine = m.sqrt(f * f - curvature * e)  # of the angle of incidence
        along = e / (f + cosine)
        x, y, s = x + along * dx, y + along * dy, s + along * ds
        spare.append(clear2 - (x * x + y * y))
        bend = m.sqrt(1.0 - ratio * ratio * (1.0 - cosine * cosine)) - ratio * cosine
        lean = bend * curvature
        dx, dy, ds = ratio * dx - lean * x, ratio * dy - lean * y, ratio * ds + bend - lean * s
    return Passage(SkewRay(x, y, s, dx, dy, ds), tuple(spare))
