import numpy as np
import pytest

from labcal.errors import InputError
from labcal.scene.catalogue import load_scene
from labcal.scene.plan import planned_takes
from labcal.scene.print import TruePrint
from labcal.scene.truth import true_dots
from labcal.scene.views import planned_views
from labcal.shoot.manifest import Role


def test_the_stage_moves_the_target_by_half_a_pitch() -> None:
    train, test = planned_views(load_scene("webcam-plane"), seed=0)
    assert train.role is Role.TRAIN
    assert test.role is Role.TEST
    np.testing.assert_array_equal(train.T_world_target[:3, 3], [650.0, 650.0, 200.0])
    step = test.T_world_target[:3, 3] - train.T_world_target[:3, 3]
    np.testing.assert_allclose(step, [700 / 24, 700 / 18, 0.0], atol=1e-9)
    for view in (train, test):
        np.testing.assert_array_equal(view.T_world_target[:3, :3], np.eye(3))
        np.testing.assert_array_equal(view.T_world_target_nominal, view.T_world_target)


def test_poses_in_the_hand_come_from_the_seed_and_nobody_is_told() -> None:
    scene = load_scene("webcam-handheld")
    once, again, other = planned_views(scene, 3), planned_views(scene, 3), planned_views(scene, 4)
    assert len(once) == 20
    assert sum(view.role is Role.TEST for view in once) == 4
    assert all(view.T_world_target_nominal is None for view in once)
    for a, b in zip(once, again, strict=True):
        np.testing.assert_array_equal(a.T_world_target, b.T_world_target)
    assert not np.array_equal(once[0].T_world_target, other[0].T_world_target)


def test_poses_in_the_hand_show_the_rings_and_cover_pictures_and_angles() -> None:
    scene = load_scene("still-handheld")
    cameras = scene.true_cameras()
    views = planned_views(scene, 0)
    takes = planned_takes(scene, views, 0).takes
    middle = np.mean([camera.centre for camera in cameras.values()], axis=0)
    rings = [row * scene.target.cols + col for col, row in scene.target.ring_indices]
    seen, tilts = [], []
    for view in views:
        board = view.T_world_target[:3, :3] @ scene.target.points().mean(axis=0) + view.T_world_target[:3, 3]
        towards = (middle - board) / np.linalg.norm(middle - board)
        tilts.append(np.degrees(np.arccos(towards @ view.T_world_target[:3, 2])))
    for take in takes:
        dots = true_dots(scene, TruePrint.of(scene.target, scene.board, 0), take)
        assert dots.visible[rings].all()
        assert dots.visible.mean() >= 0.6
        seen.append(dots.centre[dots.visible] / take.device.size)
    assert 35.0 < max(tilts) <= 45.0 + 1e-9
    low, high = np.concatenate(seen).min(axis=0), np.concatenate(seen).max(axis=0)
    assert (low < 0.1).all()
    assert (high > 0.9).all()


def test_a_target_too_near_is_an_error_that_says_what_to_move() -> None:
    scene = load_scene("still-handheld", ("placement.centre_mm=[1000, 0, 900]",))
    with pytest.raises(InputError, match="centre_mm"):
        planned_views(scene, 0)
