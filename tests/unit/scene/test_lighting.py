import numpy as np
import pytest

from labcal.scene.catalogue import load_scene
from labcal.scene.lighting import brightest_board, irradiance, lamp_pose
from labcal.scene.room import Lamp
from labcal.scene.views import planned_views


def lamp(**changes: object) -> Lamp:
    values = {"centre_mm": (0, 0, 1000), "look_at_mm": (0, 0, 0), "size_mm": (400, 600), "radiance": 2.0}
    return Lamp.model_validate(values | changes)


def test_light_of_a_panel_overhead_is_the_configuration_factors() -> None:
    # A small patch facing a parallel rectangle with a corner above it (Howell, entry B-3), four times.
    a, b = 0.2, 0.3  # half sides over height
    factor = (2.0 / np.pi) * (
        a / np.hypot(1, a) * np.arctan(b / np.hypot(1, a))
        + b / np.hypot(1, b) * np.arctan(a / np.hypot(1, b))
    )
    # The panel's sides lie along x and y in one order or the other; from below its middle both are the same.
    light = irradiance(lamp(), np.zeros((1, 3)), np.array([0.0, 0.0, 1.0]))
    assert light[0] == pytest.approx(np.pi * 2.0 * factor, rel=2e-3)


def test_a_panel_shines_to_one_side_only() -> None:
    above = np.array([[0.0, 0.0, 2000.0]])
    assert irradiance(lamp(), above, np.array([0.0, 0.0, -1.0]))[0] == 0.0
    assert irradiance(lamp(), np.zeros((1, 3)), np.array([0.0, 0.0, -1.0]))[0] == 0.0


@pytest.mark.parametrize("focus", [(0, 0, 0), (1000, 0, 1000), (0, -1000, 1000)])
def test_a_lamps_z_axis_points_at_what_it_looks_at(focus: tuple[int, int, int]) -> None:
    T_world_lamp = lamp_pose(lamp(look_at_mm=focus))
    towards = np.array(focus) - [0, 0, 1000]
    np.testing.assert_allclose(T_world_lamp[:3, 2], towards / np.linalg.norm(towards), atol=1e-12)
    assert np.linalg.det(T_world_lamp[:3, :3]) == pytest.approx(1.0)


def test_the_brightest_board_counts_every_view() -> None:
    scene = load_scene("webcam-volume")
    views = planned_views(scene, 0)
    each = np.array([brightest_board(scene, (view,)) for view in views])
    np.testing.assert_array_equal(brightest_board(scene, views), each.max(axis=0))
    assert each[3].max() > each[0].max()  # Z = 1 m lies nearer to the lamps
