import numpy as np
import pytest
from scipy.spatial.transform import Rotation

from labcal.cameras.camera import Camera
from labcal.geometry.poses import pose
from labcal.guide.next_pose.findable import Findable
from labcal.guide.next_pose.first_poses import FIRST_POSES
from labcal.guide.next_pose.picture_faults import repeated
from labcal.guide.next_pose.words import HeldBefore, lacks_words, pose_words
from labcal.targets.catalogue import load_target

CAMERA = Camera(
    [[1000.0, 0.0, 320.0], [0.0, 1000.0, 240.0], [0.0, 0.0, 1.0]],
    "pinhole",
    (0.0,) * 5,
    np.eye(4),
    (640, 480),
)
FACING = np.diag([1.0, -1.0, -1.0])
MIDDLE = np.array([50.0, 40.0, 0.0])


def held(
    turn: tuple[float, float, float], place: tuple[float, float, float] = (0.0, 0.0, 600.0)
) -> np.ndarray:
    """Return a pose that is turned about the camera's axes, degrees, from facing it."""
    R = Rotation.from_rotvec(np.radians(turn)).as_matrix() @ FACING
    return pose(R, np.array(place) - R @ MIDDLE)


@pytest.mark.parametrize(
    ("edge", "words"),
    [((0.0, -1.0), "tilt the top away"), ((0.0, 1.0), "tilt the bottom away"),
     ((1.0, 0.0), "tilt the right side away"), ((-1.0, 0.0), "tilt the left side away"),
     ((-0.7, -0.7), "tilt the upper left corner away"), ((0.7, 0.7), "tilt the lower right corner away")],
)  # fmt: skip
def test_the_edge_that_is_named_is_the_one_that_is_farther_away(
    edge: tuple[float, float], words: str
) -> None:
    T = held((30.0 * edge[1], -30.0 * edge[0], 0.0))
    x, y = edge
    board = MIDDLE + np.array([40.0 * x, -40.0 * y, 0.0])  # y is down in the picture, and up on the board
    assert (T[:3, :3] @ board + T[:3, 3])[2] > 600.0
    assert words in pose_words(["left"], [CAMERA], T, MIDDLE, HeldBefore(None))


def test_distance_place_and_turn_are_told_beside_the_pose_before() -> None:
    before = held((0.0, 0.0, 0.0))
    closer = pose_words(
        ["left"], [CAMERA], held((0.0, 0.0, 90.0), (-70.0, 60.0, 400.0)), MIDDLE, HeldBefore(before)
    )
    assert closer.startswith("Closer, about 41 cm from the cameras, in the lower left of the picture")
    assert closer.endswith("turned a quarter clockwise")
    farther = pose_words(
        ["left"], [CAMERA], held((0.0, 0.0, 0.0), (0.0, 0.0, 800.0)), MIDDLE, HeldBefore(before)
    )
    assert (
        farther == "Farther, about 80 cm from the cameras, in the middle of the picture, facing the cameras"
    )


def test_distances_are_shares_of_the_last_one_until_a_calibration_knows_them() -> None:
    before = HeldBefore(held((0.0, 0.0, 0.0)), 0.15)
    for place, words in (
        (400.0, "Closer, at about 65% of the distance before, in"),
        (600.0, "As far as before, in"),
        (810.0, "Farther, at about 135% of the distance before, in"),
    ):
        told = pose_words(["left"], [CAMERA], held((0.0, 0.0, 0.0), (0.0, 0.0, place)), MIDDLE, before)
        assert told.startswith(words)
        assert " cm" not in told


def test_first_poses_tilt_the_edge_that_their_words_name() -> None:
    for first in FIRST_POSES[1:]:
        x, y = first.edge
        for word, there in (("top", y < 0), ("bottom", y > 0), ("right", x > 0), ("left", x < 0)):
            assert there or f"the {word} " not in first.words


def test_a_pose_that_was_taken_before_is_named_and_one_that_differs_is_not() -> None:
    poses = {
        "a": held((0.0, 0.0, 0.0)),
        "b": held((2.0, 0.0, 0.0), (5.0, 0.0, 605.0)),
        "c": held((20.0, 0.0, 0.0)),
    }
    assert repeated(poses, "a", MIDDLE) is None
    assert repeated(poses, "b", MIDDLE) == "a"
    assert repeated(poses, "c", MIDDLE) is None


def test_empty_corners_of_pictures_are_named() -> None:
    cells = np.ones((6, 8), dtype=np.int64)
    cells[:3, :2] = 0
    assert lacks_words([("left", cells), ("right", np.ones((6, 8), dtype=np.int64))]) == [
        "no dots yet in the upper left of camera left"
    ]


def test_the_outline_begins_at_dot_0_0_and_goes_around_the_dots() -> None:
    target = load_target("rings-10x8")
    outline, radius = Findable.of(target).outline(), 0.5 * target.outer_diameters_mm().min()
    np.testing.assert_allclose(outline[0], [-radius, -radius, 0.0])
    np.testing.assert_allclose(outline[16], target.points()[-1] + [radius, radius, 0.0])
