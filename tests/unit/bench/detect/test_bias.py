"""The benchmark of the centre bias, with the whole of its figures."""

import numpy as np

from labcal.bench.detect.bias import (
    RADIUS_PX,
    TILT_DEG,
    VIEWS,
    bench_camera,
    bench_target,
    bias_checks,
    hand_poses,
)


def test_the_correction_restores_what_centroids_spoil() -> None:
    checks = bias_checks(3)
    assert len(checks) == 10
    assert [check.name for check in checks if not check.ok] == []


def test_the_poses_are_those_asked_for() -> None:
    poses = hand_poses(bench_camera(), bench_target(), 3)
    assert len(poses) == VIEWS
    tilts = np.degrees(np.arccos([-T[2, 2] for T in poses]))
    assert 55.0 < tilts.max() < TILT_DEG
    middle = [T @ [*bench_target().points().mean(axis=0), 1.0] for T in poses]
    radii = bench_camera().K[0, 0] * 3.0 / np.array(middle)[:, 2]
    assert 0.75 * RADIUS_PX < radii.min() < radii.max() <= RADIUS_PX + 1e-9
