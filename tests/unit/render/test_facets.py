"""Bodies of triangles against the volumes and areas of what they stand for."""

import numpy as np
import pytest

from labcal.render.facets import Facets, box_facets, cylinder_facets, ring_facets, sheet_facets
from labcal.scene.board import Bend
from labcal.scene.surface import Surface
from labcal.targets.grid import DotGrid

WHOLE: frozenset[str] = frozenset()


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


def test_a_box_encloses_its_volume() -> None:
    box = box_facets((20.0, 30.0, 7.0), WHOLE)
    assert volume(box) == pytest.approx(20.0 * 30.0 * 7.0)
    assert len(box.faces) == 12
    np.testing.assert_allclose(normals(box).sum(axis=0), 0.0, atol=1e-9)


@pytest.mark.parametrize(("left_out", "axis", "sign"), [("-z", 2, -1.0), ("+z", 2, 1.0), ("+x", 0, 1.0)])
def test_a_face_is_left_out_by_name(left_out: str, axis: int, sign: float) -> None:
    size = np.array([20.0, 30.0, 7.0])
    open_box = box_facets((20.0, 30.0, 7.0), frozenset([left_out]))
    missing = np.zeros(3)
    missing[axis] = -sign * 2.0 * size.prod() / size[axis]
    assert len(open_box.faces) == 10
    np.testing.assert_allclose(normals(open_box).sum(axis=0), missing, atol=1e-9)


def test_texture_coordinates_of_a_box_are_millimetres() -> None:
    box = box_facets((20.0, 30.0, 7.0), WHOLE)
    uv = box.uv[box.faces]
    across = np.linalg.det(np.stack([uv[:, 1] - uv[:, 0], uv[:, 2] - uv[:, 0]], axis=1))
    np.testing.assert_allclose(np.abs(across), np.linalg.norm(normals(box), axis=1))


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
