"""Intersection of rays with flat rectangles, one by one.

A laboratory is a dozen or two of rectangles. Testing all of them takes a third of the time of Embree's tree
(decision "panel by panel"), since every lane does the same work. Scenes with other shapes go through Mitsuba.
"""

from dataclasses import dataclass

import numpy as np

from labcal.arrays import Pose
from labcal.render.variant import Jit


@dataclass(frozen=True)
class Hit:
    """The first intersection of rays."""

    t: Jit
    """Distance along the ray, mm; infinite where nothing is met."""
    number: Jit
    """Index of the panel."""
    u: Jit
    v: Jit
    """Place on the panel, from -1 to 1."""


class Panels:
    """Rectangles from -1 to 1 in x and y of their own frames, facing +z.

    Parameters
    ----------
    mi : module
        Mitsuba with the variant in use.
    T_world_panel : list of ndarray, shape (4, 4)
        Affine: the columns are half the edges, the normal, and the middle, mm.
    occludes : list of bool
        For each panel whether it can come between a surface and a lamp.
    """

    def __init__(self, mi: Jit, T_world_panel: list[Pose], occludes: list[bool]) -> None:
        import drjit as dr  # noqa: PLC0415 -- only after ensure_llvm

        self._mi, self._dr = mi, dr
        # Opaque numbers, so that the kernel stays the same when panels move.
        self._rows = [
            [[dr.opaque(mi.Float, float(n)) for n in row] for row in np.linalg.inv(T)[:3]]
            for T in T_world_panel
        ]
        self._rows_in_the_way = [rows for rows, here in zip(self._rows, occludes, strict=True) if here]
        normals = np.array([np.cross(T[:3, 0], T[:3, 1]) for T in T_world_panel])
        normals /= np.linalg.norm(normals, axis=1, keepdims=True)
        self._normals = mi.Normal3f(normals.T.astype(np.float32))

    def of_shapes(self, shapes: Jit, numbers: list[int]) -> Jit:
        """Return the shapes of the panels from all shapes, by the index of each panel."""
        dr, mi = self._dr, self._mi
        return dr.gather(mi.ShapePtr, shapes, mi.UInt32(numbers))

    def closest(self, ray: Jit) -> Hit:
        """Return the first intersection of each ray with a panel."""
        mi, dr = self._mi, self._dr
        t, number = mi.Float(dr.inf), mi.UInt32(0)
        u, v = mi.Float(0.0), mi.Float(0.0)
        for candidate, rows in enumerate(self._rows):
            t_here, u_here, v_here, meets = self._meet(rows, ray)
            nearer = meets & (t_here < t)
            t, number = dr.select(nearer, t_here, t), dr.select(nearer, candidate, number)
            u, v = dr.select(nearer, u_here, u), dr.select(nearer, v_here, v)
        return Hit(t, number, u, v)

    def blocked(self, ray: Jit) -> Jit:
        """Return a mask of rays that meet an occluding panel before their end."""
        blocked = self._mi.Bool(False)
        for rows in self._rows_in_the_way:
            t, _, _, meets = self._meet(rows, ray)
            blocked |= meets & (t < ray.maxt)
        return blocked

    def interaction(self, ray: Jit, hit: Hit, shapes: Jit) -> Jit:
        """Return Mitsuba's record of surface points.

        Parameters
        ----------
        ray : Ray3f
        hit : Hit
            Of these rays.
        shapes : ShapePtr
            Mitsuba's shape of every panel, in the order of the panels.
        """
        mi, dr = self._mi, self._dr
        valid = hit.t < dr.inf
        si = dr.zeros(mi.SurfaceInteraction3f, dr.width(hit.t))
        si.t = hit.t
        si.time, si.wavelengths = ray.time, ray.wavelengths
        si.p = ray.o + dr.select(valid, hit.t, 0.0) * ray.d
        si.n = dr.gather(mi.Normal3f, self._normals, hit.number, valid)
        si.sh_frame = mi.Frame3f(si.n)
        si.uv = mi.Point2f(0.5 * hit.u + 0.5, 0.5 * hit.v + 0.5)
        si.shape = dr.gather(mi.ShapePtr, shapes, hit.number, valid)
        si.wi = si.to_local(-ray.d)
        return si

    def _meet(self, rows: list[list[Jit]], ray: Jit) -> tuple[Jit, Jit, Jit, Jit]:
        """Return distance and position of the intersection with the plane of a panel, and a mask of hits."""
        dr = self._dr
        o, d = ray.o, ray.d
        (ux, uy, uz, u0), (vx, vy, vz, v0), (nx, ny, nz, n0) = rows
        t = -(nx * o.x + ny * o.y + nz * o.z + n0) / (nx * d.x + ny * d.y + nz * d.z)
        p = o + t * d
        u, v = ux * p.x + uy * p.y + uz * p.z + u0, vx * p.x + vy * p.y + vz * p.z + v0
        return t, u, v, (t > 0.0) & (dr.abs(u) <= 1.0) & (dr.abs(v) <= 1.0)
