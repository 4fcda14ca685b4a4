"""Solid bodies and the straight lines that they block: exact, without a renderer."""

from dataclasses import dataclass, replace

import numpy as np
from jaxtyping import Bool, Float64

from labcal.arrays import Mask, Pose, Vectors3
from labcal.geometry.poses import inverse, transform
from labcal.scene.quantities import Colour

Starts = Float64[np.ndarray, "*#paths 3"]
Ends = Float64[np.ndarray, "*#paths 3"]
Met = Bool[np.ndarray, "*#paths"]


@dataclass(frozen=True)
class Block:
    """A box; with a thickness of 0 along z it is a panel."""

    name: str
    T_world_block: Pose
    """Pose of its middle, mm."""
    size_mm: tuple[float, float, float]
    reflectance: Colour

    def grown(self, by_mm: float) -> "Block":
        """Return a box that holds every point within a distance of this one."""
        width, height, depth = (side + 2.0 * by_mm for side in self.size_mm)
        return replace(self, size_mm=(width, height, depth))

    def meets(self, start: Starts, end: Ends) -> Met:
        """Return whether the lines from `start` to `end` meet the body (world, mm, shapes (..., 3)).

        Notes
        -----
        The slabs of Kay and Kajiya (1986).
        """
        T_block_world = inverse(self.T_world_block)
        origin = transform(T_block_world, start)
        way = transform(T_block_world, end) - origin
        enters, leaves = np.zeros(way.shape[:-1]), np.ones(way.shape[:-1])
        for axis, side in enumerate(self.size_mm):
            first, last = _slab(origin[..., axis], way[..., axis], 0.5 * side)
            enters, leaves = np.maximum(enters, first), np.minimum(leaves, last)
        return np.asarray(enters <= leaves)

    def holds(self, p: Vectors3) -> Mask:
        """Return whether world points are inside."""
        local = transform(inverse(self.T_world_block), p)
        return np.asarray((np.abs(local) < 0.5 * np.array(self.size_mm)).all(axis=-1))


@dataclass(frozen=True)
class Cylinder:
    """A cylinder with flat ends; with a length of 0 and a hole it is a ring."""

    name: str
    T_world_cylinder: Pose
    """Pose of its middle, mm; z is the axis."""
    length_mm: float
    diameter_mm: float
    reflectance: Colour
    hole_mm: float = 0.0
    """Diameter of the hole along its axis; only a ring of no thickness may have one."""

    def grown(self, by_mm: float) -> "Cylinder":
        """Return a cylinder that holds every point within a distance of this one."""
        length, diameter = self.length_mm + 2.0 * by_mm, self.diameter_mm + 2.0 * by_mm
        return replace(self, length_mm=length, diameter_mm=diameter, hole_mm=0.0)

    def meets(self, start: Starts, end: Ends) -> Met:
        """Return whether the lines from `start` to `end` meet the body (world, mm, shapes (..., 3))."""
        T_cylinder_world = inverse(self.T_world_cylinder)
        origin = transform(T_cylinder_world, start)
        way = transform(T_cylinder_world, end) - origin
        enters, leaves = _slab(origin[..., 2], way[..., 2], 0.5 * self.length_mm)
        first, last = _round(origin, way, 0.5 * self.diameter_mm)
        enters, leaves = np.maximum.reduce([enters, first, np.zeros_like(first)]), np.minimum(leaves, last)
        met = np.minimum(leaves, 1.0) >= enters
        if self.hole_mm > 0.0:
            first, last = _round(origin, way, 0.5 * self.hole_mm)
            met &= ~((first < enters) & (enters < last))
        return np.asarray(met)

    def holds(self, p: Vectors3) -> Mask:
        """Return whether world points are inside."""
        x, y, z = np.moveaxis(transform(inverse(self.T_world_cylinder), p), -1, 0)
        inside = (np.abs(z) < 0.5 * self.length_mm) & (np.hypot(x, y) < 0.5 * self.diameter_mm)
        return np.asarray(inside)


Solid = Block | Cylinder


def _slab(origin: np.ndarray, way: np.ndarray, half: float) -> tuple[np.ndarray, np.ndarray]:
    """Return the interval of a line parameter within `half` of zero; first > last if it is empty."""
    within = np.abs(origin) <= half
    with np.errstate(divide="ignore", invalid="ignore"):
        a, b = (-half - origin) / way, (half - origin) / way
    along = way == 0.0
    first = np.where(along, np.where(within, -np.inf, np.inf), np.minimum(a, b))
    last = np.where(along, np.where(within, np.inf, -np.inf), np.maximum(a, b))
    return first, last


def _round(origin: np.ndarray, way: np.ndarray, radius: float) -> tuple[np.ndarray, np.ndarray]:
    """Return the interval of a line parameter within `radius` of the z axis."""
    a = (way[..., :2] ** 2).sum(axis=-1)
    b = (way[..., :2] * origin[..., :2]).sum(axis=-1)
    c = (origin[..., :2] ** 2).sum(axis=-1) - radius**2
    with np.errstate(divide="ignore", invalid="ignore"):
        root = np.sqrt(np.maximum(b * b - a * c, 0.0))
        first, last = (-b - root) / a, (-b + root) / a
    never = b * b < a * c
    along = a == 0.0
    first = np.where(along, np.where(c <= 0.0, -np.inf, np.inf), np.where(never, np.inf, first))
    last = np.where(along, np.where(c <= 0.0, np.inf, -np.inf), np.where(never, -np.inf, last))
    return first, last
