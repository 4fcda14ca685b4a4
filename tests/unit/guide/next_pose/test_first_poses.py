import numpy as np
import pytest
from held_target import target

from labcal.cameras.camera import Camera
from labcal.capture.guide_settings import GuideSettings
from labcal.correspond.detections import Detections
from labcal.geometry.poses import inverse, pose, transform
from labcal.guide.next_pose.findable import MOST_TILT_DEG, OUTLINE_STEPS, Findable
from labcal.guide.next_pose.first_poses import (
    FIRST_POSES,
    camera_matrix,
    first_outlines,
    pose_by_pixels,
    turned_away,
)
from labcal.guide.next_pose.rough_rig import RoughRig

SIZE = (1280, 960)
SIZES = {"left": SIZE, "right": SIZE}


def rig(focal: float) -> tuple[Camera, Camera]:
    """Return two cameras 0.34 rad apart that look at a place whose distance goes with the focal length."""
    far, angle = 0.7 * focal, -0.34
    R = np.array([[np.cos(angle), 0.0, -np.sin(angle)], [0.0, 1.0, 0.0], [np.sin(angle), 0.0, np.cos(angle)]])
    shift = np.array([0.0, 0.0, far]) - R @ [0.0, 0.0, far]
    K = camera_matrix(focal, SIZE)
    return tuple(
        Camera(K, "brown5", (-0.05, 0.0, 0.0, 0.0, 0.0), T, SIZE) for T in (np.eye(4), pose(R, shift))
    )


def first_view(cameras: tuple[Camera, Camera], tilt: np.ndarray) -> Detections:
    R = tilt @ np.diag([1.0, -1.0, -1.0])
    T = pose(R, [0.0, 0.0, 0.7 * cameras[0].K[0, 0]] - R @ Findable.of(target()).middle)
    q = [camera.project(transform(T, target().points())).q for camera in cameras]
    q = [one + 0.02 * np.random.default_rng(4).standard_normal(one.shape) for one in q]
    n = target().count
    return Detections(
        np.repeat(["view-1"], 2 * n), np.repeat(["left", "right"], n), np.repeat(["l.png", "r.png"], n),
        np.tile(SIZE, (2 * n, 1)), np.tile(target().indices(), (2, 1)), np.ones(2 * n, dtype=bool),
        np.concatenate(q), np.tile(4e-4 * np.eye(2), (2 * n, 1, 1)), np.repeat(["ok"], 2 * n),
    )  # fmt: skip


@pytest.mark.parametrize("focal", [1100.0, 4500.0])
def test_one_tilted_view_tells_the_rig_roughly(focal: float) -> None:
    cameras = rig(focal)
    view = first_view(cameras, turned_away(FIRST_POSES[0]))
    rough = RoughRig.of([view], SIZES, target(), GuideSettings())
    assert rough is not None
    for found, true in zip(rough.cameras, cameras, strict=True):
        assert found.K[0, 0] == pytest.approx(true.K[0, 0], rel=0.15)
    moved = rough.cameras[1].T_cam_world @ inverse(cameras[1].T_cam_world)
    turned = np.degrees(np.arccos(min(1.0, 0.5 * (np.trace(moved[:3, :3]) - 1.0))))
    assert turned < 6.0
    assert np.linalg.norm(rough.centre) == pytest.approx(0.7 * focal, rel=0.15)
    assert np.all(np.linalg.eigvalsh(rough.covariance) > 0.0)


def test_a_view_that_faces_the_camera_gives_the_usual_field_of_view() -> None:
    cameras = rig(4500.0)
    rough = RoughRig.of([first_view(cameras, np.eye(3))], SIZES, target(), GuideSettings())
    assert rough is not None
    assert rough.cameras[0].K[0, 0] == pytest.approx(1.1 * SIZE[0])


@pytest.mark.parametrize("number", range(1, len(FIRST_POSES)))
def test_outlines_of_first_tilts_are_flat_enough_through_any_lens(number: int) -> None:
    """Through long lenses the guess of the lens may tilt the first view the wrong way."""
    for focal in (1100.0, 4500.0):
        cameras = rig(focal)
        view = first_view(cameras, turned_away(FIRST_POSES[0]))
        outline = first_outlines(number, SIZES, view, target())["left"][::OUTLINE_STEPS]
        T = pose_by_pixels(Findable.of(target()).outline()[::OUTLINE_STEPS], outline, cameras[0].K)
        toward = -T[:3, 3] / np.linalg.norm(T[:3, 3])
        assert np.degrees(np.arccos(T[:3, 2] @ toward)) < MOST_TILT_DEG - 10.0
