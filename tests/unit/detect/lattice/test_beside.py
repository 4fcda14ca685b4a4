"""Nodes and spots beside each other."""

import numpy as np

from labcal.detect.lattice.beside import (
    distance_to_nearest,
    empty_beside,
    nearest_alike,
    neighbour_counts,
    step_lengths,
)


def test_neighbours_lie_within_two_steps_and_a_node_is_none_of_its_own() -> None:
    grid = np.full((4, 4), -1)
    grid[0, 0], grid[1, 1], grid[3, 3] = 4, 5, 6
    assert neighbour_counts(grid, np.array([[0, 0], [1, 1], [0, 3], [3, 3]])).tolist() == [1, 2, 1, 1]


def test_empty_nodes_beside_others_come_sorted() -> None:
    found = empty_beside(np.array([[5, -2], [5, -1]]))
    assert found.tolist() == sorted(found.tolist())
    assert len(found) == 10
    assert [5, -2] not in found.tolist()
    assert [4, -3] in found.tolist()


def test_a_spot_of_another_size_or_at_the_frame_is_not_alike() -> None:
    centre = np.array([[10.0, 10.0], [11.0, 10.0], [12.0, 10.0]])
    outline = np.stack([9.0 * np.eye(2), 100.0 * np.eye(2), 9.0 * np.eye(2)])
    blobs = centre, outline, np.array([True, False, False])
    place, shape = np.array([[10.0, 10.0], [40.0, 10.0]]), np.stack([9.0 * np.eye(2)] * 2)
    assert nearest_alike(place, shape, blobs, (0.5, 1.0)).tolist() == [2, -1]
    assert distance_to_nearest(place, centre).tolist() == [0.0, 28.0]


def test_a_step_is_measured_in_radii_of_the_ellipses_at_its_ends() -> None:
    nodes, spots = np.array([[0, 0], [1, 0], [0, 1]]), np.array([2, 0, 1])
    centre = np.array([[30.0, 0.0], [0.0, 8.0], [0.0, 0.0]])
    shape = np.tile(np.diag([25.0, 4.0]), (3, 1, 1))
    np.testing.assert_allclose(step_lengths(nodes, spots, centre, shape, (1, 0)), [6.0])
    np.testing.assert_allclose(step_lengths(nodes, spots, centre, shape, (0, 1)), [4.0])
