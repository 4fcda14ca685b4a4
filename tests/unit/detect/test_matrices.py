"""Compiled stacks of 2 x 2 matrices give what NumPy's give."""

import numpy as np
import pytest

from labcal.detect import matrices
from labcal.geometry import two_by_two


@pytest.fixture
def shapes() -> np.ndarray:
    random = np.random.default_rng(5)
    factor = random.normal(size=(40, 2, 2))
    return np.asarray(factor @ np.swapaxes(factor, 1, 2) + 0.1 * np.eye(2))


@pytest.mark.parametrize("name", ["inverses", "matrix_roots", "eigenvalues"])
def test_the_same_numbers_as_of_numpy(name: str, shapes: np.ndarray) -> None:
    np.testing.assert_allclose(getattr(matrices, name)(shapes), getattr(two_by_two, name)(shapes), rtol=1e-13)


def test_one_shape_for_all_maps_or_one_map_for_all_shapes(shapes: np.ndarray) -> None:
    maps = np.random.default_rng(6).normal(size=shapes.shape)
    there = np.swapaxes(maps, 1, 2)
    np.testing.assert_allclose(matrices.mapped(maps, shapes), maps @ shapes @ there, rtol=1e-11, atol=1e-13)
    one = matrices.mapped(maps, shapes[:1])
    np.testing.assert_allclose(one, maps @ shapes[0] @ there, rtol=1e-11, atol=1e-13)
    one = matrices.mapped(maps[:1], shapes)
    np.testing.assert_allclose(one, maps[0] @ shapes @ there[0], rtol=1e-11, atol=1e-13)


def test_the_geometric_mean_is_congruent_to_both(shapes: np.ndarray) -> None:
    A, B = shapes[:20], shapes[20:]
    mean = matrices.geometric_means(A, B)
    np.testing.assert_allclose(mean @ np.linalg.inv(A) @ mean, B, rtol=1e-9, atol=1e-12)  # Riccati's equation


def test_inside_is_what_lies_whole_in_the_frame() -> None:
    centre = np.array([[5.0, 5.0], [3.9, 5.0], [5.0, 95.1]])
    shape = np.tile(np.diag([16.0, 16.0]), (3, 1, 1))
    assert matrices.inside(centre, shape, (200, 100), 0.0).tolist() == [True, False, False]
    assert matrices.inside(centre, shape, (200, 100), 0.2).tolist() == [True, True, True]
    np.testing.assert_allclose(matrices.mean_radii(shape), 4.0)
