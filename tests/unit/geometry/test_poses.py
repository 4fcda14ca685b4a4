import cv2
import numpy as np
import pytest

from labcal.errors import InputError
from labcal.geometry.poses import (
    from_fixed_angles_deg,
    from_quaternion,
    from_rotation_vector,
    inverse,
    look_at,
    pose,
    quaternion,
    require_rigid,
    rigid_alignment,
    rotation_vector,
    transform,
)


def random_pose(rng: np.random.Generator) -> np.ndarray:
    """Return a pose whose rotation OpenCV makes."""
    R, _ = cv2.Rodrigues(rng.uniform(-1.7, 1.7, 3))
    T = np.eye(4)
    T[:3, :3], T[:3, 3] = R, rng.normal(size=3) * 500
    return T


def test_transform_and_inverse_are_matrix_products() -> None:
    rng = np.random.default_rng(1)
    T_ab, T_bc = random_pose(rng), random_pose(rng)
    p_c = rng.normal(size=(2, 7, 3)) * 100
    homogeneous = np.concatenate([p_c, np.ones((2, 7, 1))], axis=-1)
    expected = (homogeneous @ (T_ab @ T_bc).T)[..., :3]
    np.testing.assert_allclose(transform(T_ab, transform(T_bc, p_c)), expected, atol=1e-10)
    np.testing.assert_allclose(inverse(T_ab), np.linalg.inv(T_ab), atol=1e-10)
    np.testing.assert_array_equal(pose(T_ab[:3, :3], T_ab[:3, 3]), T_ab)


def test_rotation_vectors_are_those_of_opencv() -> None:
    rng = np.random.default_rng(2)
    for _ in range(20):
        vector = rng.uniform(-1.7, 1.7, 3)
        T = from_rotation_vector(vector, np.array([1.0, 2.0, 3.0]))
        np.testing.assert_allclose(T[:3, :3], cv2.Rodrigues(vector)[0], atol=1e-12)
        np.testing.assert_array_equal(T[:3, 3], [1.0, 2.0, 3.0])
        np.testing.assert_allclose(rotation_vector(T), cv2.Rodrigues(T[:3, :3])[0][:, 0], atol=1e-9)


def test_look_at_puts_the_focus_ahead_and_up_at_the_top() -> None:
    eye, focus, up = np.array([100.0, -300, 900]), np.array([400.0, 500, 100]), np.array([0.0, 0, 1])
    T_cam_world = look_at(eye, focus, up)
    require_rigid(T_cam_world, "look_at")
    np.testing.assert_allclose(transform(T_cam_world, eye), 0, atol=1e-9)
    distance = float(np.linalg.norm(focus - eye))
    np.testing.assert_allclose(transform(T_cam_world, focus), [0, 0, distance], atol=1e-9)
    above = T_cam_world[:3, :3] @ up
    assert above[1] < 0  # y points down
    assert abs(above[0]) < 1e-12


@pytest.mark.parametrize(("focus", "up"), [((0, 0, 0), (0, 0, 1)), ((0, 0, 5), (0, 0, 1))])
def test_look_at_refuses_what_gives_no_picture(focus: tuple[int, ...], up: tuple[int, ...]) -> None:
    with pytest.raises(InputError, match="'up' not along its view"):
        look_at(np.zeros(3), np.array(focus, dtype=float), np.array(up, dtype=float))


@pytest.mark.parametrize(
    ("row", "column", "value"), [(3, 0, 1.0), (0, 0, 1.1), (0, 0, -1.0), (0, 3, np.nan), (3, 3, 2.0)]
)
def test_what_is_not_rigid_is_refused(row: int, column: int, value: float) -> None:
    T = np.eye(4)
    require_rigid(T, "T_ab")
    T[row, column] = value
    with pytest.raises(InputError, match="T_ab must be a rigid"):
        require_rigid(T, "T_ab")


def test_rigid_alignment_finds_the_pose_and_the_least_squares() -> None:
    rng = np.random.default_rng(3)
    for flat in (1.0, 0.0):
        T_ab = random_pose(rng)
        p_b = rng.normal(size=(40, 3)) * [100, 80, 50 * flat]
        np.testing.assert_allclose(rigid_alignment(transform(T_ab, p_b), p_b), T_ab, atol=1e-9)
        p_a = transform(T_ab, p_b) + rng.normal(size=(40, 3))
        found = rigid_alignment(p_a, p_b)
        require_rigid(found, "the alignment")
        best = ((transform(found, p_b) - p_a) ** 2).sum()
        for _ in range(20):  # no pose near it is better
            near = found @ from_rotation_vector(rng.normal(size=3) * 1e-4, rng.normal(size=3) * 1e-2)
            assert ((transform(near, p_b) - p_a) ** 2).sum() > best


def test_rigid_alignment_never_mirrors() -> None:
    p = np.random.default_rng(4).normal(size=(30, 3))
    assert np.linalg.det(rigid_alignment(p * [1, 1, -1], p)[:3, :3]) == pytest.approx(1)


def test_rigid_alignment_refuses_too_little() -> None:
    line = np.outer(np.arange(9.0), [1.0, 2.0, -3.0]) + 700
    with pytest.raises(InputError, match="one line"):
        rigid_alignment(line, line)
    with pytest.raises(InputError, match="at least 3 points, but 2"):
        rigid_alignment(line[:2], line[:2])


def test_quaternions_have_their_real_part_first() -> None:
    half = np.sqrt(0.5)
    quarter_about_z = np.array([[0.0, -1.0, 0.0], [1.0, 0.0, 0.0], [0.0, 0.0, 1.0]])
    np.testing.assert_allclose(from_quaternion(np.array([half, 0.0, 0.0, half])), quarter_about_z, atol=1e-15)
    np.testing.assert_allclose(np.abs(quaternion(quarter_about_z)), [half, 0.0, 0.0, half], atol=1e-15)


def test_fixed_angles_turn_about_x_first() -> None:
    """About x by 90 degrees, then about the fixed z by 90: y goes to z and stays there, z to -y and to x."""
    expected = np.array([[0.0, 0.0, 1.0], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0]])
    np.testing.assert_allclose(from_fixed_angles_deg([90.0, 0.0, 90.0]), expected, atol=1e-15)
