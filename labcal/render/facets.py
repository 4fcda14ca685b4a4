"""Round and bent bodies as triangles."""

from dataclasses import dataclass
from types import ModuleType
from typing import Any

import numpy as np

from labcal.arrays import Pose, Vectors3
from labcal.geometry.poses import transform
from labcal.render.variant import Jit
from labcal.scene.surface import Surface

SIDES = 96
"""Flat sides of a round body; at a radius of 10 mm they are within 0.003 mm of it."""


@dataclass(frozen=True)
class Facets:
    """Triangles in a body's own frame, mm."""

    vertices: Vectors3
    """(n, 3)."""
    faces: np.ndarray
    """(m, 3), numbers of vertices, counter-clockwise seen from outside."""
    uv: np.ndarray
    """(n, 2), texture coordinates."""
    normals: Vectors3 | None = None
    """(n, 3), of a curved surface; none for one that is flat facet by facet."""

    def mesh(self, mi: ModuleType, name: str, T_world_body: Pose, inside: dict[str, Any]) -> Jit:
        """Return Mitsuba's mesh at a pose, with its inner objects (``bsdf``, ``emitter``)."""
        properties = mi.Properties()
        for key, value in inside.items():
            properties[key] = mi.load_dict(value)
        mesh = mi.Mesh(
            name,
            len(self.vertices),
            len(self.faces),
            props=properties,
            has_vertex_normals=self.normals is not None,
            has_vertex_texcoords=True,
        )
        parameters = mi.traverse(mesh)
        parameters["faces"] = mi.UInt32(self.faces.ravel().astype(np.uint32))
        parameters["vertex_texcoords"] = mi.Float(self.uv.ravel().astype(np.float32))
        for key, values in self.at(T_world_body).items():
            parameters[key] = mi.Float(values)
        parameters.update()
        return mesh

    def at(self, T_world_body: Pose) -> dict[str, np.ndarray]:
        """Return the parameters of Mitsuba's mesh that place it at a pose, float32."""
        placed = {"vertex_positions": transform(T_world_body, self.vertices)}
        if self.normals is not None:
            placed["vertex_normals"] = self.normals @ T_world_body[:3, :3].T
        return {key: values.ravel().astype(np.float32) for key, values in placed.items()}


def cylinder_facets(length_mm: float, diameter_mm: float) -> Facets:
    """Return a cylinder about the origin with its axis along z and the cross-section's area of the circle."""
    around, edge = _circle(diameter_mm)
    up = np.array([0.0, 0.0, 0.5 * length_mm])
    flat = np.tile([0.0, 0.0, 1.0], (SIDES, 1))
    low, high = edge - up, edge + up
    number = np.arange(SIDES)
    after = (number + 1) % SIDES
    side = [
        np.stack([number, after, SIDES + after], -1),
        np.stack([number, SIDES + after, SIDES + number], -1),
    ]
    fan = np.stack([np.zeros(SIDES - 2, dtype=np.int64), number[1:-1], number[2:]], axis=-1)
    ends = [2 * SIDES + fan[:, ::-1], 3 * SIDES + fan]
    vertices = np.concatenate([low, high, low, high])
    normals = np.concatenate([around, around, -flat, flat])
    return Facets(vertices, np.concatenate([*side, *ends]), np.zeros((len(vertices), 2)), normals)


def ring_facets(inner_mm: float, outer_mm: float) -> Facets:
    """Return a flat ring of two diameters in the x-y plane that faces +z, of the true area."""
    (_, inner), (_, outer) = _circle(inner_mm), _circle(outer_mm)
    number = np.arange(SIDES)
    after = (number + 1) % SIDES
    faces = np.concatenate(
        [
            np.stack([number, SIDES + number, SIDES + after], axis=-1),
            np.stack([number, SIDES + after, after], axis=-1),
        ]
    )
    return Facets(np.concatenate([inner, outer]), faces, np.zeros((2 * SIDES, 2)))


def sheet_facets(surface: Surface) -> Facets:
    """Return the surface of a board in facets that deviate from it by at most 0.0005 mm.

    Texture coordinates run from 0 to 1 along the board's edges and are exact everywhere, since the bend moves
    points along z alone.
    """
    n = surface.cells()
    steps = np.linspace(0.0, 1.0, n + 1)
    uv = np.stack(np.meshgrid(steps, steps), axis=-1).reshape(-1, 2)
    xy = surface.middle + (2.0 * uv - 1.0) * surface.half
    corner = (np.arange(n)[:, None] * (n + 1) + np.arange(n)).ravel()
    faces = np.concatenate(
        [
            np.stack([corner, corner + 1, corner + n + 2], axis=-1),
            np.stack([corner, corner + n + 2, corner + n + 1], axis=-1),
        ]
    )
    return Facets(surface.points(xy), faces, uv, surface.normals(xy))


def _circle(diameter_mm: float) -> tuple[Vectors3, Vectors3]:
    """Return unit vectors around z, and the corners of the polygon with the circle's area, (SIDES, 3)."""
    angle = 2.0 * np.pi * np.arange(SIDES) / SIDES
    around = np.stack([np.cos(angle), np.sin(angle), np.zeros(SIDES)], axis=-1)
    step = 2.0 * np.pi / SIDES
    return around, 0.5 * diameter_mm * float(np.sqrt(step / np.sin(step))) * around
