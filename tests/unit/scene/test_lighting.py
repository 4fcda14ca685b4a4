import numpy as np
import pytest

from labcal.scene.catalogue import load_scene
from labcal.scene.lamps import Ambient, Panel, Ring, Spot
from labcal.scene.lighting import ambient_radiance, brightest_board, irradiance, lamp_body, lamp_pose
from labcal.scene.views import planned_views

UP = np.array([0.0, 0.0, 1.0])
OVERHEAD = {"centre_mm": (0, 0, 1000), "look_at_mm": (0, 0, 0)}


def lamp(**changes: object) -> Panel:
    return Panel.model_validate(OVERHEAD | {"size_mm": (400, 600), "radiance": 2.0} | changes)


def test_light_of_a_panel_overhead_is_the_configuration_factors() -> None:
    # A small patch facing a parallel rectangle with a corner above it (Howell, entry B-3), four times.
    a, b = 0.2, 0.3  # half sides over height
    factor = (2.0 / np.pi) * (
        a / np.hypot(1, a) * np.arctan(b / np.hypot(1, a))
        + b / np.hypot(1, b) * np.arctan(a / np.hypot(1, b))
    )
    # The panel's sides lie along x and y in one order or the other; from below its middle both are the same.
    light = irradiance(lamp(), np.zeros((1, 3)), UP)
    assert light[0] == pytest.approx(np.pi * 2.0 * factor, rel=2e-3)


def test_light_of_a_ring_overhead_is_the_configuration_factors() -> None:
    # A small patch facing a parallel disc with its middle above it (Howell, entry B-12), outer minus inner.
    ring = Ring.model_validate(
        OVERHEAD | {"kind": "ring", "inner_diameter_mm": 300, "outer_diameter_mm": 800, "radiance": 2.0}
    )
    factor = 1.0 / (1.0 + (1000 / 400) ** 2) - 1.0 / (1.0 + (1000 / 150) ** 2)
    assert irradiance(ring, np.zeros((1, 3)), UP)[0] == pytest.approx(np.pi * 2.0 * factor, rel=1e-3)


def test_light_of_a_spotlight_falls_off_as_its_distance_and_its_rim_say() -> None:
    spot = Spot.model_validate(
        OVERHEAD | {"kind": "spot", "intensity": 3e6, "cutoff_deg": 30, "beam_deg": 20}
    )
    angle = np.radians([0.0, 19.9, 25.0, 29.0, 30.1])
    p = np.stack([1000 * np.tan(angle), np.zeros(5), np.zeros(5)], axis=-1)
    expected = 3.0 * np.cos(angle) ** 3 * [1.0, 1.0, 0.5, 0.1, 0.0]
    np.testing.assert_allclose(irradiance(spot, p, UP), expected, rtol=1e-9, atol=1e-12)


def test_light_from_everywhere_gives_a_board_its_reflectance_times_the_radiance() -> None:
    scene = load_scene("webcam-plane", ("lamps=[{kind: ambient, radiance: 2, colour: [1, 0.5, 0.25]}]",))
    brightest = brightest_board(scene, planned_views(scene, 0))
    np.testing.assert_allclose(brightest, 2.0 * np.array([1, 0.5, 0.25]) * scene.board.light, rtol=1e-12)
    np.testing.assert_array_equal(ambient_radiance(scene), [2.0, 1.0, 0.5])
    ambient = Ambient(kind="ambient", radiance=1.5)
    np.testing.assert_allclose(irradiance(ambient, np.zeros((2, 3)), -UP), 1.5 * np.pi)


def test_a_panel_shines_to_one_side_only() -> None:
    above = np.array([[0.0, 0.0, 2000.0]])
    assert irradiance(lamp(), above, -UP)[0] == 0.0
    assert irradiance(lamp(), np.zeros((1, 3)), -UP)[0] == 0.0


def test_each_point_may_have_a_normal_of_its_own() -> None:
    p = np.array([[0.0, 0.0, 0.0], [200.0, 0.0, 0.0]])
    normals = np.array([[0.0, 0.0, 1.0], [0.6, 0.0, 0.8]])
    together = irradiance(lamp(), p, normals)
    alone = [irradiance(lamp(), p[i : i + 1], normals[i])[0] for i in range(2)]
    np.testing.assert_array_equal(together, alone)


@pytest.mark.parametrize("focus", [(0, 0, 0), (1000, 0, 1000), (0, -1000, 1000)])
def test_a_lamps_z_axis_points_at_what_it_looks_at(focus: tuple[int, int, int]) -> None:
    T_world_lamp = lamp_pose(lamp(look_at_mm=focus))
    towards = np.array(focus) - [0, 0, 1000]
    np.testing.assert_allclose(T_world_lamp[:3, 2], towards / np.linalg.norm(towards), atol=1e-12)
    assert np.linalg.det(T_world_lamp[:3, :3]) == pytest.approx(1.0)


def test_a_panel_and_a_ring_are_in_the_way_and_a_ring_lets_through_its_hole() -> None:
    ring = Ring.model_validate(
        OVERHEAD | {"kind": "ring", "inner_diameter_mm": 100, "outer_diameter_mm": 200, "radiance": 1.0}
    )
    eye, x = np.array([[0.0, 0.0, 2000.0]]), np.array([0.0, 90.0, 110.0, 190.0, 210.0])
    ends = np.stack([x, np.zeros(5), np.zeros(5)], axis=-1)  # half as far out in the lamp's plane
    body = lamp_body("lamps.0", ring)
    assert body is not None
    np.testing.assert_array_equal(body.meets(eye, ends), [False, False, True, True, False])
    panel = lamp_body("lamps.1", lamp(size_mm=(100, 100)))
    assert panel is not None
    np.testing.assert_array_equal(panel.meets(eye, ends), [True, True, False, False, False])
    assert lamp_body("lamps.2", Ambient(kind="ambient", radiance=1.0)) is None


def test_the_brightest_board_counts_every_view() -> None:
    scene = load_scene("webcam-volume")
    views = planned_views(scene, 0)
    each = np.array([brightest_board(scene, (view,)) for view in views])
    np.testing.assert_array_equal(brightest_board(scene, views), each.max(axis=0))
    assert each[3].max() > each[0].max()  # Z = 1 m lies nearer to the lamps


def test_a_board_whose_left_edge_turns_to_a_low_lamp_on_the_left_is_brighter() -> None:
    place = "centre_mm: [-2000, 1000, 1200], look_at_mm: [1000, 1000, 200]"
    lamps = f"lamps=[{{{place}, size_mm: [9, 9], radiance: 1}}]"
    views = planned_views(load_scene("webcam-plane"), 0)
    scenes = [load_scene("webcam-plane", (lamps, f"board.bend.along_x_mm={rise}")) for rise in (0, -80)]
    flat, bent = (brightest_board(scene, views) for scene in scenes)
    assert (bent > 1.5 * flat).all()
