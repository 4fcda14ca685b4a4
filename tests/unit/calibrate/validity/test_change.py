import numpy as np
import pytest

from labcal import examples
from labcal.calibrate.adjustment.state import Freedom, Layout, Lenses, RigState
from labcal.calibrate.validity.change import Change, ChangeKind, changes_in_room, possible_changes
from labcal.calibrate.validity.room import in_room, out_of_room, rig_columns, rig_positions
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


@pytest.mark.parametrize("kind", [kind for kind in ChangeKind if kind is not ChangeKind.TOGETHER])
@pytest.mark.parametrize("cameras", [(0,), (1,)])
def test_columns_are_the_derivatives_of_what_is_applied(kind: ChangeKind, cameras: tuple[int, ...]) -> None:
    change = Change(kind, cameras, cameras)
    columns = change.columns(STATE)
    assert columns.shape == (parameter_count(CAMERAS), change.count)
    for number, step in enumerate(np.eye(change.count)):
        ahead, behind = (parameters(change.applied(STATE, sign * 1e-6 * step)) for sign in (1.0, -1.0))
        np.testing.assert_allclose(columns[:, number], (ahead - behind) / 2e-6, atol=1e-6, rtol=1e-6)


@pytest.mark.parametrize("kind", [ChangeKind.TOGETHER, ChangeKind.MOVED, ChangeKind.SEVERAL])
def test_columns_in_a_room_are_derivatives_of_the_cameras_places(kind: ChangeKind) -> None:
    state = RigState(in_room(CAMERAS), np.eye(4)[None], np.zeros((1, 3)))
    change = next(one for one in changes_in_room((1, 2)) if one.kind is kind)
    columns = change.columns(state)

    def moved(step: np.ndarray) -> RigState:
        # The room is the world, whatever moves in it.
        return change.applied(state, step)

    for number, step in enumerate(np.eye(change.count)):
        ahead, behind = (moved(sign * 1e-6 * step) for sign in (1.0, -1.0))
        found = []
        for camera, (one, other) in enumerate(zip(ahead.cameras, behind.cameras, strict=True)):
            found += [*(np.array(one.intrinsics) - other.intrinsics), *(one.dist - other.dist)]
            if camera:
                R = one.T_cam_world[:3, :3] @ other.T_cam_world[:3, :3].T
                found += [R[2, 1], R[0, 2], R[1, 0], *(one.T_cam_world - other.T_cam_world)[:3, 3]]
        np.testing.assert_allclose(columns[:, number], np.array(found) / 2e-6, atol=1e-6, rtol=1e-6)


def test_a_rig_that_moves_as_one_body_is_the_same_rig() -> None:
    state = RigState(in_room(CAMERAS), np.eye(4)[None], np.zeros((1, 3)))
    together = next(one for one in changes_in_room((1, 2)) if one.kind is ChangeKind.TOGETHER)
    moved = together.applied(state, np.array([0.1, -0.2, 0.05, 3.0, 2.0, -1.0]))
    for now, before in zip(out_of_room(moved.cameras), CAMERAS, strict=True):
        np.testing.assert_allclose(now.T_cam_world, before.T_cam_world, atol=1e-12)
    np.testing.assert_allclose(rig_columns(moved) @ together.columns(moved), 0.0, atol=1e-10)


def test_parameters_of_the_rig_are_told_from_places_in_the_room() -> None:
    state = RigState(in_room(CAMERAS), np.eye(4)[None], np.zeros((1, 3)))
    state = Change(ChangeKind.MOVED, (1,), (1,)).applied(state, np.array([0.1, -0.2, 0.05, 3.0, 2.0, -1.0]))
    layout = Layout(state, Freedom(Lenses.FREE, np.zeros((3, 0))))
    columns = rig_columns(state)
    assert (columns[:-6, rig_positions(state)[:-6]] == np.eye(len(columns) - 6)).all()
    for number, step in enumerate(np.eye(layout.count)):
        pair = [
            out_of_room(layout.stepped(sign * 1e-6 * step, np.zeros((1, 6))).cameras)[1].T_cam_world
            for sign in (1.0, -1.0)
        ]
        R = pair[0][:3, :3] @ pair[1][:3, :3].T
        found = np.array([R[2, 1], R[0, 2], R[1, 0], *(pair[0] - pair[1])[:3, 3]]) / 2e-6
        np.testing.assert_allclose(columns[-6:, number], found, atol=1e-5, rtol=1e-6)


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
