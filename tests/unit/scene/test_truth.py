import cv2
import numpy as np
import pytest

from labcal.geometry.poses import rotation_vector
from labcal.scene.catalogue import load_scene
from labcal.scene.print import TruePrint
from labcal.scene.truth import true_dots
from labcal.scene.views import planned_views


@pytest.mark.parametrize("name", ["webcam-plane", "still-handheld"])
def test_centres_agree_with_opencv(name: str) -> None:
    scene = load_scene(name)
    for view in planned_views(scene, 0)[:4]:
        for camera_name, camera in scene.true_cameras().items():
            dots = true_dots(scene, TruePrint.of(scene.target, scene.board, 0), view, camera_name, camera)
            expected, _ = cv2.projectPoints(
                dots.point,
                rotation_vector(camera.T_cam_world),
                camera.T_cam_world[:3, 3],
                camera.K,
                camera.dist,
            )
            shown = dots.visible
            assert shown.sum() >= 60
            np.testing.assert_allclose(dots.centre[shown], expected[shown, 0], rtol=0.0, atol=1e-9)


def test_points_are_the_targets_own_at_its_place() -> None:
    scene = load_scene("webcam-plane")
    view = planned_views(scene, 0)[0]
    dots = true_dots(
        scene, TruePrint.of(scene.target, scene.board, 0), view, "left", scene.true_cameras()["left"]
    )
    np.testing.assert_allclose(dots.point[0], [650.0, 650.0, 200.0])
    np.testing.assert_allclose(dots.point[-1], [1350.0, 1350.0, 200.0])
    np.testing.assert_array_equal(dots.index[-1], [12, 9])


def test_a_dot_that_the_frame_cuts_is_not_visible() -> None:
    scene = load_scene("webcam-plane", ("cameras.left.look_at_mm=[1500, 1010, 200]",))
    camera = scene.true_cameras()["left"]
    dots = true_dots(
        scene, TruePrint.of(scene.target, scene.board, 0), planned_views(scene, 0)[0], "left", camera
    )
    radius = 7.0  # px, no dot is larger
    inside = (dots.centre > radius).all(axis=1) & (dots.centre < np.array(camera.size) - radius).all(axis=1)
    outside = (dots.centre < -0.5).any(axis=1) | (dots.centre > np.array(camera.size) - 0.5).any(axis=1)
    cut = ~inside & ~outside
    assert dots.visible[inside].all()
    assert not dots.visible[outside].any()
    assert (~dots.visible[cut]).any()


def test_nothing_is_visible_from_behind() -> None:
    scene = load_scene("webcam-plane", ("cameras.left.eye_mm=[720, 640, -700]",))
    dots = true_dots(
        scene,
        TruePrint.of(scene.target, scene.board, 0),
        planned_views(scene, 0)[0],
        "left",
        scene.true_cameras()["left"],
    )
    assert not dots.visible.any()
