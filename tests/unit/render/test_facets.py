"""Bodies of triangles against the volumes and areas of what they stand for."""

import numpy as np
import pytest

from labcal.render.facets import Facets, cylinder_facets, ring_facets, sheet_facets
from labcal.scene.board import Bend
from labcal.scene.surface import Surface
from labcal.targets.grid import DotGrid


def corners(facets: Facets) -> np.ndarray:
    """Return the corners of every triangle, shape (m, 3, 3)."""
    return facets.vertices[facets.faces]


def normals(facets: Facets) -> np.ndarray:
    """Return twice the area of every triangle along its outward normal, shape (m, 3)."""
    a, b, c = np.moveaxis(corners(facets), 1, 0)
    return np.cross(b - a, c - a)


def volume(facets: Facets) -> float:
    """Return the enclosed volume, by the divergence theorem; negative where the triangles face inwards."""
    return float((normals(facets) * corners(facets)[:, 0]).sum() / 6.0)


def test_a_cylinder_has_the_volume_and_nearly_the_shape_of_the_round_one() -> None:
    rod = cylinder_facets(50.0, 20.0)
    assert volume(rod) == pytest.approx(np.pi * 10.0**2 * 50.0, rel=1e-12)
    radius = np.hypot(*rod.vertices[:, :2].T)
    middles = np.hypot(*corners(rod).mean(axis=1)[: 2 * 96, :2].T)  # a third of a side's width off its middle
    assert 10.0 < radius.max() < 10.004
    assert middles.min() > 9.997
    assert rod.normals is not None
    outward = np.einsum("mi,mki->mk", normals(rod), rod.normals[rod.faces])
    assert (outward > 0.0).all()


def test_a_ring_has_the_true_area_and_faces_its_axis() -> None:
    ring = ring_facets(60.0, 100.0)
    area = 0.5 * normals(ring).sum(axis=0)
    np.testing.assert_allclose(area, [0.0, 0.0, np.pi * (50.0**2 - 30.0**2)], atol=1e-9)
    assert (normals(ring)[:, 2] > 0.0).all()


def test_a_sheet_lies_on_its_surface_with_uv_along_its_edges(grid: DotGrid) -> None:
    surface = Surface.of(grid, Bend(along_x_mm=2.0, along_y_mm=-1.0, twist_mm=0.5))
    sheet = sheet_facets(surface)
    x_min, y_min, x_max, y_max = grid.extent_mm
    xy = np.array([x_min, y_min]) + sheet.uv * [x_max - x_min, y_max - y_min]
    np.testing.assert_allclose(sheet.vertices, surface.points(xy), atol=1e-9)
    assert (normals(sheet)[:, 2] > 0.0).all()
    assert 0.5 * normals(sheet)[:, 2].sum() == pytest.approx((x_max - x_min) * (y_max - y_min))
