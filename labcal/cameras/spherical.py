"""A ray through spherical surfaces, one after the other: the exact skew trace (Welford 1986, chapter 4).

Coordinates x and y lie across the lens's axis, s along it in the direction of travel. A surface is four
parameters: the gap to it from the vertex before, its curvature (positive with its centre farther along), the
ratio of the refractive indices before and behind, and its clear radius squared.
"""

from dataclasses import dataclass

from labcal.cameras.mathematics import Mathematics, Number

SURFACE = 4
"""Numbers of a surface: gap in mm, curvature in 1/mm, index ratio, clear radius squared in mm^2."""


@dataclass(frozen=True)
class AxialRay:
    """A point, with s counted from the vertex of the surface passed last, and a unit direction.

    Across the axis it has the two coordinates x and y, or one: a ray in a plane with the axis stays there.
    """

    across: tuple[Number, ...]
    s: Number
    slant: tuple[Number, ...]
    """The direction's parts across the axis."""
    ds: Number


@dataclass(frozen=True)
class Passage:
    """A ray behind surfaces, and by how much it stayed within the clear radius of each, in mm^2."""

    ray: AxialRay
    spare: tuple[Number, ...]


def through(m: Mathematics, surfaces: tuple[Number, ...], ray: AxialRay) -> Passage:
    """Follow a ray through surfaces.

    Parameters
    ----------
    m : Mathematics
    surfaces : tuple of number
        :data:`SURFACE` parameters each, in the order of travel.
    ray : AxialRay
        With s counted from the point from which the first gap counts.

    Returns
    -------
    Passage
        NaN where a surface is missed or light is totally reflected.
    """
    across, s, slant, ds = ray.across, ray.s, ray.slant, ray.ds
    spare = []
    for first in range(0, len(surfaces), SURFACE):
        gap, curvature, ratio, clear2 = surfaces[first : first + SURFACE]
        s = s - gap
        e = curvature * _dot(m, across, across, s * s) - 2.0 * s
        f = ds - curvature * _dot(m, across, slant, s * ds)
        cosine = m.sqrt(m.fma(f, f, -curvature * e))  # of the angle of incidence
        along = e / (f + cosine)
        across = tuple(m.fma(along, dx, x) for x, dx in zip(across, slant, strict=True))
        s = m.fma(along, ds, s)
        spare.append(clear2 - _dot(m, across, across, 0.0))
        bend = m.sqrt(1.0 - ratio * ratio * (1.0 - cosine * cosine)) - ratio * cosine
        lean = -bend * curvature
        slant = tuple(m.fma(lean, x, ratio * dx) for x, dx in zip(across, slant, strict=True))
        ds = m.fma(lean, s, m.fma(ratio, ds, bend))
    return Passage(AxialRay(across, s, slant, ds), tuple(spare))


def _dot(m: Mathematics, a: tuple[Number, ...], b: tuple[Number, ...], more: Number) -> Number:
    """Return the scalar product of two tuples, and what is added to it."""
    for x, y in zip(a, b, strict=True):
        more = m.fma(x, y, more)
    return more
