"""The pose of points in space from directions."""

import numpy as np
import pytest
from scipy.spatial.transform import Rotation

from labcal.errors import InputError
from labcal.geometry.pose_from_rays import pose_from_rays
from labcal.geometry.poses import pose, transform


def test_exact_directions_give_the_pose_also_from_within_the_points() -> None:
    random = np.random.default_rng(1)
    p = random.uniform(-100.0, 100.0, (40, 3))
    for t in ([10.0, -20.0, 900.0], [0.0, 5.0, -8.0]):  # before the camera, and all around it
        true = pose(Rotation.random(rng=random).as_matrix(), np.array(t))
        seen = transform(true, p)
        found = pose_from_rays(seen / np.linalg.norm(seen, axis=1, keepdims=True), p)
        np.testing.assert_allclose(found, true, atol=1e-7)


def test_what_determines_no_pose_is_refused() -> None:
    p = np.random.default_rng(2).uniform(-100.0, 100.0, (40, 3))
    with pytest.raises(InputError, match="at least 6"):
        pose_from_rays(p[:5], p[:5])
    p[:, 2] = 0.0
    seen = p + np.array([0.0, 0.0, 500.0])
    with pytest.raises(InputError, match="one plane"):
        pose_from_rays(seen / np.linalg.norm(seen, axis=1, keepdims=True), p)
