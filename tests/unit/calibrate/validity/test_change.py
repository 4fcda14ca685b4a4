import numpy as np
import pytest

from labcal import examples
from labcal.calibrate.adjustment.state import RigState
from labcal.calibrate.validity.change import Change, ChangeKind, possible_changes
from labcal.cameras.parameter_derivatives import parameter_count

CAMERAS = tuple(examples.rig().camera(name) for name in ("left", "right"))
STATE = RigState(CAMERAS, np.eye(4)[None], np.zeros((1, 3)))


def parameters(state: RigState) -> np.ndarray:
    """Return what columns are derivatives of; the pose by small differences from the start."""
    found: list[float] = []
    for number, (camera, before) in enumerate(zip(state.cameras, CAMERAS, strict=True)):
        found += [*camera.intrinsics, *camera.dist[:5]]
        if number:
            R = camera.T_cam_world[:3, :3] @ before.T_cam_world[:3, :3].T
            found += [R[2, 1], R[0, 2], R[1, 0], *camera.T_cam_world[:3, 3]]
    return np.array(found)


@pytest.mark.parametrize("kind", list(ChangeKind))
@pytest.mark.parametrize("cameras", [(0,), (1,)])
def test_columns_are_the_derivatives_of_what_is_applied(kind: ChangeKind, cameras: tuple[int, ...]) -> None:
    change = Change(kind, cameras, cameras)
    columns = change.columns(STATE)
    assert columns.shape == (parameter_count(CAMERAS), change.count)
    for number, step in enumerate(np.eye(change.count)):
        ahead, behind = (parameters(change.applied(STATE, sign * 1e-6 * step)) for sign in (1.0, -1.0))
        np.testing.assert_allclose(columns[:, number], (ahead - behind) / 2e-6, atol=1e-6, rtol=1e-6)


def test_a_first_camera_that_moves_takes_the_world_and_the_target_with_it() -> None:
    size = np.array([0.1, -0.2, 0.05, 3.0, 2.0, -1.0])
    moved = Change(ChangeKind.MOVED, (0,), (0,)).applied(STATE, size)
    np.testing.assert_array_equal(moved.cameras[0].T_cam_world, np.eye(4))
    still, after = (state.cameras[1].T_cam_world @ state.T_world_target[0] for state in (STATE, moved))
    np.testing.assert_allclose(after, still, atol=1e-12)


def test_between_two_cameras_a_shift_is_one_of_either_and_with_three_it_is_not() -> None:
    of_pair = [one.suspects for one in possible_changes((0, 1)) if one.kind is ChangeKind.SHIFTED]
    of_three = [one.suspects for one in possible_changes((0, 1, 2)) if one.kind is ChangeKind.SHIFTED]
    assert (of_pair, of_three) == ([(0, 1)], [(0,), (1,), (2,)])
    assert [one.kind for one in possible_changes((0,))] == [ChangeKind.REFOCUSED]
