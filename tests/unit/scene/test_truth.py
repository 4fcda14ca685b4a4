import cv2
import numpy as np
import pytest

from labcal.geometry.poses import rotation_vector
from labcal.scene.catalogue import load_scene
from labcal.scene.model import Scene
from labcal.scene.plan import planned_takes
from labcal.scene.print import TruePrint
from labcal.scene.take import Take
from labcal.scene.truth import true_dots
from labcal.scene.views import planned_views
from labcal.shoot.truth import TrueDots


def takes(scene: Scene) -> tuple[Take, ...]:
    return planned_takes(scene, planned_views(scene, 0), 0).takes


def seen(scene: Scene, take: Take) -> TrueDots:
    return true_dots(scene, TruePrint.of(scene.target, scene.board, 0), take)


@pytest.mark.parametrize("name", ["webcam-plane", "still-handheld"])
def test_centres_agree_with_opencv(name: str) -> None:
    scene = load_scene(name)
    for take in takes(scene)[:8]:
        dots, camera = seen(scene, take), take.device
        expected, _ = cv2.projectPoints(
            dots.point, rotation_vector(camera.T_cam_world), camera.T_cam_world[:3, 3], camera.K, camera.dist
        )
        shown = dots.visible
        assert shown.sum() >= 60
        np.testing.assert_allclose(dots.centre[shown], expected[shown, 0], rtol=0.0, atol=1e-9)


def test_points_are_the_targets_own_at_its_place() -> None:
    scene = load_scene("webcam-plane")
    dots = seen(scene, takes(scene)[0])
    np.testing.assert_allclose(dots.point[0], [650.0, 650.0, 200.0])
    np.testing.assert_allclose(dots.point[-1], [1350.0, 1350.0, 200.0])
    np.testing.assert_array_equal(dots.index[-1], [12, 9])


def test_a_dot_that_the_frame_cuts_is_not_visible() -> None:
    scene = load_scene("webcam-plane", ("cameras.left.look_at_mm=[1500, 1010, 200]",))
    take = takes(scene)[0]
    dots, size = seen(scene, take), np.array(take.device.size)
    radius = 7.0  # px, no dot is larger
    inside = (dots.centre > radius).all(axis=1) & (dots.centre < size - radius).all(axis=1)
    outside = (dots.centre < -0.5).any(axis=1) | (dots.centre > size - 0.5).any(axis=1)
    cut = ~inside & ~outside
    assert dots.visible[inside].all()
    assert not dots.visible[outside].any()
    assert (~dots.visible[cut]).any()


def test_nothing_is_visible_from_behind() -> None:
    scene = load_scene("webcam-plane", ("cameras.left.eye_mm=[720, 640, -700]",))
    dots = seen(scene, takes(scene)[0])
    assert dots.camera == "left"
    assert not dots.visible.any()
