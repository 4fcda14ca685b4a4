"""The pose of a plane from directions: exact ones, also sideways and behind, and what determines none."""

import numpy as np
import pytest
from scipy.spatial.transform import Rotation

from labcal.errors import InputError
from labcal.geometry.plane_pose import plane_pose
from labcal.geometry.poses import pose

GRID = np.stack(np.meshgrid(np.arange(6) * 10.0, np.arange(4) * 10.0), axis=-1).reshape(-1, 2)


@pytest.mark.parametrize("at", [(0.0, 0.0, 200.0), (180.0, -60.0, 20.0), (-200.0, 30.0, -90.0)])
@pytest.mark.parametrize("turn", [(0.3, -0.6, 0.2), (3.0, 0.2, -0.4)])
def test_exact_directions_give_the_pose(at: tuple[float, ...], turn: tuple[float, ...]) -> None:
    T = pose(Rotation.from_rotvec(turn).as_matrix(), np.array(at))
    p = np.column_stack([GRID, np.zeros(len(GRID))]) @ T[:3, :3].T + T[:3, 3]
    found = plane_pose(p / np.linalg.norm(p, axis=1, keepdims=True), GRID)
    np.testing.assert_allclose(found, T, atol=1e-6)


def test_what_determines_no_pose_is_refused() -> None:
    line = np.column_stack([np.arange(8) * 10.0, np.zeros(8)])
    p = np.column_stack([line, np.full(8, 300.0)])
    with pytest.raises(InputError, match="on one line"):
        plane_pose(p / np.linalg.norm(p, axis=1, keepdims=True), line)
    with pytest.raises(InputError, match="at least 4 points, but got 3"):
        plane_pose(np.eye(3), GRID[:3])
