import numpy as np
import pytest

from labcal.render.forms import Body, Flat, Form, forms
from labcal.scene.catalogue import load_scene
from labcal.scene.furniture import blocks
from labcal.scene.views import planned_views


def corners(form: Form) -> np.ndarray:
    """Return the corners of a rectangle in the world, counter-clockwise seen from its front, mm."""
    assert isinstance(form, Flat)
    square = np.array(
        [[-1.0, -1.0, 0.0, 1.0], [1.0, -1.0, 0.0, 1.0], [1.0, 1.0, 0.0, 1.0], [-1.0, 1.0, 0.0, 1.0]]
    )
    return (square @ form.T_world_panel.T)[:, :3]


def outward(form: Form) -> np.ndarray:
    """Return a rectangle's area along its normal, mm2."""
    a, b, _, d = corners(form)
    return np.cross(b - a, d - a)


@pytest.mark.parametrize("name", ["webcam-plane", "webcam-handheld"])
def test_the_print_is_where_the_target_is_and_faces_its_viewer(name: str) -> None:
    scene = load_scene(name)
    for view in planned_views(scene, 0)[:2]:
        shown = corners(forms(scene, view.T_world_target)["print"])
        x_min, y_min, x_max, y_max = scene.target.extent_mm
        local = np.array([[x_min, y_min, 0], [x_max, y_min, 0], [x_max, y_max, 0], [x_min, y_max, 0]])
        T = view.T_world_target
        np.testing.assert_allclose(shown, local @ T[:3, :3].T + T[:3, 3], atol=1e-9)


@pytest.mark.parametrize("name", ["webcam-plane", "webcam-volume", "webcam-handheld"])
def test_faces_lie_on_their_block_and_face_outwards(name: str) -> None:
    scene = load_scene(name, ("occluders=[{kind: box, centre_mm: [0, 0, 0], size_mm: [40, 50, 60]}]",))
    T_world_target = planned_views(scene, 0)[-1].T_world_target
    shapes = forms(scene, T_world_target)
    for prefix, block in zip(("table", "plate", "support"), blocks(scene, T_world_target), strict=True):
        faces = [form for key, form in shapes.items() if key.startswith(f"{prefix}-")]
        assert faces
        for face in faces:
            local = (corners(face) - block.T_world_block[:3, 3]) @ block.T_world_block[:3, :3]
            np.testing.assert_allclose(np.abs(local), np.tile(0.5 * np.array(block.size_mm), (4, 1)))
            assert outward(face) @ (corners(face).mean(axis=0) - block.T_world_block[:3, 3]) > 0.0
    box = [outward(form) for key, form in shapes.items() if key.startswith("occluder-0-")]
    np.testing.assert_allclose(np.sum(box, axis=0), 0.0, atol=1e-9)
    assert np.linalg.norm(box, axis=1).sum() == pytest.approx(2 * (40 * 50 + 50 * 60 + 60 * 40))


def test_the_room_is_closed_where_floor_and_wall_meet() -> None:
    shapes = forms(load_scene("webcam-plane"), np.eye(4))
    floor, wall = corners(shapes["floor"]), corners(shapes["wall"])
    np.testing.assert_allclose(floor[[3, 2]], wall[[0, 1]])
    assert outward(shapes["floor"])[2] > 0.0
    assert outward(shapes["wall"])[1] < 0.0


def test_what_no_camera_sees_is_left_out_and_names_stay_the_same() -> None:
    scene = load_scene("webcam-volume")
    names = [tuple(forms(scene, view.T_world_target)) for view in planned_views(scene, 0)]
    assert len(set(names)) == 1
    assert {"table-top", "plate-left", "support-front"} <= set(names[0])
    assert not {"table-bottom", "plate-top", "plate-bottom", "support-top", "support-bottom"} & set(names[0])
    from_the_side = load_scene("webcam-plane", ("cameras.left.eye_mm=[-200, 640, 1850]",))
    assert "table-left" in forms(from_the_side, np.eye(4))
    assert "table-left" not in forms(load_scene("webcam-plane"), np.eye(4))
    small = load_scene("webcam-plane", ("target=rings-10x8",))  # narrower than the column that carries it
    assert "support-top" in forms(small, np.eye(4))


def test_a_bent_board_is_a_mesh_in_front_of_a_plate_with_a_front() -> None:
    scene = load_scene("webcam-plane", ("board.bend.along_x_mm=-10",))
    shapes = forms(scene, np.eye(4))
    sheet = shapes["print"]
    assert isinstance(sheet, Body)
    lowest = sheet.facets.vertices[:, 2].min()
    assert lowest == pytest.approx(-10.0)
    np.testing.assert_allclose(corners(shapes["plate-top"])[:, 2], lowest - 0.05)
