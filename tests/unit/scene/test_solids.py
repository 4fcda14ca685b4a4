"""Paths against solids, compared with points counted along each path."""

import numpy as np
import pytest

from labcal.geometry.poses import from_rotation_vector
from labcal.scene.solids import Block, Cylinder, Solid

T = from_rotation_vector(np.array([0.4, -0.7, 0.3]), np.array([30.0, -20.0, 10.0]))
GREY = (0.5, 0.5, 0.5)
SOLIDS = [Block("box", T, (40.0, 90.0, 25.0), GREY), Cylinder("rod", T, 80.0, 30.0, GREY)]


@pytest.mark.parametrize("solid", SOLIDS, ids=lambda solid: solid.name)
def test_paths_that_meet_a_solid_have_a_point_inside(solid: Solid) -> None:
    random = np.random.default_rng(3)
    start = T[:3, 3] + random.normal(0.0, 60.0, (400, 3))
    end = T[:3, 3] + random.normal(0.0, 60.0, (400, 3))
    share = np.linspace(0.0, 1.0, 1001)[:, None]
    along = start[:, None, :] + share * (end - start)[:, None, :]
    inside = solid.holds(along).any(axis=1)
    met = solid.meets(start, end)
    assert 40 < inside.sum() < 360
    assert met[inside].all()
    missed = met & ~inside  # corners that a path cuts in less than a step
    assert solid.grown(0.5).holds(along[missed]).any(axis=1).all()
    assert missed.sum() < 8


def test_paths_along_an_axis_and_paths_of_no_length_are_told() -> None:
    eye = np.eye(4)
    box, rod = Block("box", eye, (2.0, 2.0, 2.0), GREY), Cylinder("rod", eye, 2.0, 2.0, GREY)
    start = np.array([[-5.0, 0, 0], [-5.0, 1.5, 0], [0, 0, -5.0], [0, 1.5, -5.0], [0.0, 0, 0], [3.0, 0, 0]])
    end = np.array([[5.0, 0, 0], [5.0, 1.5, 0], [0, 0, 5.0], [0, 1.5, 5.0], [0.0, 0, 0], [3.0, 0, 0]])
    for solid in (box, rod):
        np.testing.assert_array_equal(
            solid.meets(start, end), [True, False, True, False, True, False], err_msg=solid.name
        )
        assert not solid.meets(start[:1], np.array([[-1.5, 0.0, 0.0]]))[0]  # it ends short of the solid
        assert not solid.meets(np.array([[1.5, 0.0, 0.0]]), end[:1])[0]  # it begins behind it


def test_what_is_grown_holds_all_that_is_near() -> None:
    random = np.random.default_rng(4)
    for solid in SOLIDS:
        p = T[:3, 3] + random.uniform(-60.0, 60.0, (2000, 3))
        near = solid.holds(p)
        assert near.sum() > 50
        assert solid.grown(5.0).holds(p[near] + 5.0 * np.array([0.6, 0.0, 0.8])).all()
