import numpy as np
import pytest
from held_target import target

from labcal.calibrate.adjustment.observations import Observations
from labcal.calibrate.adjustment.state import RigState
from labcal.calibrate.budget.expected_covariance import ExpectedCovariance
from labcal.cameras.camera import Camera
from labcal.errors import InputError
from labcal.geometry.poses import pose
from labcal.guide.next_pose.candidates import HandReach, drawn_poses
from labcal.guide.next_pose.choice import mean_squares_after, next_pose
from labcal.guide.next_pose.findable import MOST_TILT_DEG, Findable
from labcal.guide.next_pose.hand import HandError, parsed_hand_error
from labcal.guide.next_pose.information import view_information
from labcal.guide.next_pose.standing import DotVariance
from labcal.guide.next_pose.volume import MeasuredVolume
from labcal.rng import generator

SIZE = (1280, 960)
CENTRE = np.array([60.0, 0.0, 700.0])
NOISE = DotVariance(6.0, 0.02**2, 0.0)


def rig() -> tuple[Camera, ...]:
    K = [[1100.0, 0.0, 640.0], [0.0, 1100.0, 480.0], [0.0, 0.0, 1.0]]
    angle = -0.17
    R = np.array([[np.cos(angle), 0.0, -np.sin(angle)], [0.0, 1.0, 0.0], [np.sin(angle), 0.0, np.cos(angle)]])
    right = pose(R, -R @ np.array([120.0, 0.0, 0.0]))
    dist = (-0.1, 0.05, 1e-4, -1e-4, 0.0)
    return tuple(Camera(K, "brown5", dist, T, SIZE) for T in (np.eye(4), right))


def poses(count: int, seed: int = 0) -> tuple[np.ndarray, np.ndarray]:
    """Return poses at which both cameras find the target, and the dots seen, (cameras, n, dots)."""
    findable, random = Findable.of(target()), generator(seed, "test")
    drawn = drawn_poses(rig(), HandReach(CENTRE, 4), findable.middle, 40 * count, random)
    seen = [findable.seen(camera, drawn) for camera in rig()]
    both = np.flatnonzero(np.all([found for found, _ in seen], axis=0))[:count]
    assert len(both) == count
    return drawn[both], np.array([dots[both] for _, dots in seen])


def test_a_hand_is_off_by_the_angle_and_the_share_of_the_distance() -> None:
    findable = Findable.of(target())
    asked = poses(1)[0][0]
    taken = HandError(5.0, 0.05).taken(asked, findable.middle, np.random.default_rng(1))
    turn = np.degrees(np.arccos(0.5 * (np.trace(asked[:3, :3].T @ taken[:3, :3]) - 1.0)))
    held, place = (T[:3, :3] @ findable.middle + T[:3, 3] for T in (taken, asked))
    assert turn == pytest.approx(5.0)
    assert np.linalg.norm(held - place) == pytest.approx(0.05 * np.linalg.norm(place))
    assert parsed_hand_error("5deg,5%") == HandError(5.0, 0.05)


@pytest.mark.parametrize("text", ["", "5,5", "5deg", "-5deg,5%", "nandeg,5%", "5deg,60%"])
def test_errors_of_a_hand_that_are_none_are_refused_with_an_example(text: str) -> None:
    with pytest.raises(InputError, match=r"5deg,5%"):
        parsed_hand_error(text)


def test_the_target_is_found_in_front_of_the_cameras_and_not_behind_far_tilted_or_outside() -> None:
    findable, facing = Findable.of(target()), np.diag([1.0, -1.0, -1.0])
    slant = np.radians(MOST_TILT_DEG + 5.0)
    tilted = facing @ np.array(
        [[np.cos(slant), 0.0, np.sin(slant)], [0.0, 1.0, 0.0], [-np.sin(slant), 0.0, np.cos(slant)]]
    )
    away = np.diag([-1.0, -1.0, 1.0])
    held = [
        (facing, 700.0, 0.0), (facing, -700.0, 0.0), (facing, 3000.0, 0.0), (tilted, 700.0, 0.0),
        (away, 700.0, 0.0), (facing, 700.0, 500.0),
    ]  # fmt: skip
    T = np.array([pose(R, np.array([x, 0.0, z]) - R @ findable.middle) for R, z, x in held])
    assert findable.seen(rig()[0], T)[0].tolist() == [True, False, False, False, False, False]


def test_information_of_views_is_that_of_the_adjustment() -> None:
    cameras, (T, seen), findable, board = rig(), poses(12), Findable.of(target()), target()
    flat = DotVariance(1.0, 0.02**2, 0.0)

    def even(size: np.ndarray) -> np.ndarray:
        return np.full(size.shape, flat.variance)

    total = view_information(cameras, T, findable, seen, even).sum(axis=0)
    index = np.flatnonzero(np.isin(np.arange(board.count), np.arange(board.count)[:: findable.every]))
    rows = [
        (number, view, dot)
        for number in range(2)
        for view in range(len(T))
        for dot, of in zip(index, seen[number, view, findable.even], strict=True)
        if of
    ]
    camera, view, dot = np.array(rows).T
    p = np.einsum("nij,nj->ni", T[view, :3, :3], board.points()[dot]) + T[view, :3, 3]
    q = np.stack([camera_of.project(p).q for camera_of in cameras], axis=1)[np.arange(len(p)), camera]
    each = np.tile(flat.variance / findable.every * np.eye(2), (len(p), 1, 1))
    state = RigState(cameras, T, board.points())
    expected = ExpectedCovariance.of_declared(state, Observations(camera, view, dot, q, each), 0.0)
    found = np.sqrt(np.diagonal(np.linalg.inv(total)))
    np.testing.assert_allclose(found, np.sqrt(np.diagonal(expected.noise)), rtol=0.03)


def test_the_pose_chosen_leaves_less_error_than_random_ones_and_a_hand_may_be_off() -> None:
    cameras, findable = rig(), Findable.of(target())
    T, seen = poses(4)
    covariance = np.linalg.inv(view_information(cameras, T, findable, seen, NOISE).sum(axis=0))
    volume = MeasuredVolume.of(cameras, CENTRE, (200.0, 150.0, 100.0))
    chosen = next_pose(volume, covariance, findable, NOISE, HandReach(CENTRE, 4), generator(3, "test"))
    assert chosen is not None
    asked, sees = chosen
    assert sees.all()
    others, dots = poses(30, seed=5)
    seen_asked = np.array([findable.seen(camera, asked[None])[1] for camera in cameras])
    added = view_information(
        cameras, np.concatenate([asked[None], others]), findable,
        np.concatenate([seen_asked, dots], axis=1), NOISE,
    )  # fmt: skip
    left = mean_squares_after(covariance, added, volume.square_by_parameters)
    assert left[0] <= left[1:].min()
    before = float(np.trace(volume.square_by_parameters @ covariance))
    assert left[0] < before
    random = np.random.default_rng(8)
    taken = np.array([HandError().taken(asked, findable.middle, random) for _ in range(200)])
    for camera in cameras:
        assert findable.seen(camera, taken)[0].mean() >= 0.9


def test_the_usual_volume_is_what_both_cameras_see() -> None:
    volume = MeasuredVolume.of(rig(), CENTRE, None)
    for camera in rig():
        assert camera.in_picture(camera.project(volume.points).q).all()
    assert np.ptp(volume.points[:, 0]) > 300.0
    assert volume.noise_mm(0.04) == pytest.approx(2.0 * volume.noise_mm(0.01))


def test_distances_at_which_nothing_was_found_are_asked_for_no_more() -> None:
    reach = HandReach(CENTRE, 4)
    assert reach.without(0.65).near == pytest.approx(0.7)
    assert reach.without(0.9).near == pytest.approx(0.8)
    assert reach.without(1.4).far == pytest.approx(1.35)
    assert reach.without(1.05).far == pytest.approx(1.25)
