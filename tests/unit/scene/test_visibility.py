import numpy as np
import pytest

from labcal.scene.catalogue import load_scene
from labcal.scene.plan import planned_takes
from labcal.scene.print import TruePrint
from labcal.scene.truth import true_dots
from labcal.scene.views import planned_views
from labcal.shoot.truth import TrueDots


def seen(*overrides: str, camera: str = "left", view: int = 0) -> TrueDots:
    scene = load_scene("webcam-plane", overrides)
    made = TruePrint.of(scene.target, scene.board, 0)
    taken = planned_takes(scene, planned_views(scene, 0)[view : view + 1], 0).takes
    return true_dots(scene, made, next(take for take in taken if take.camera == camera))


def numbers(dots: TrueDots) -> set[tuple[int, int]]:
    """Return (col, row) of the dots that are not visible."""
    return {(col, row) for col, row in dots.index[~dots.visible].tolist()}


def test_everything_is_visible_where_nothing_is_in_the_way() -> None:
    assert numbers(seen()) == set()


def test_a_box_on_the_board_hides_what_it_covers_and_moves_with_it() -> None:
    # It reaches from x = 110 to 190 and y = 300 to 320 mm: dots (2, 4) and (3, 4), whose radius is 15 mm.
    lies = "{kind: box, frame: target, centre_mm: [150, 310, 0.5], size_mm: [80, 20, 1]}"
    for view in (0, 1):
        for camera in ("left", "right"):
            assert numbers(seen(f"occluders=[{lies}]", camera=camera, view=view)) == {(2, 4), (3, 4)}


def test_a_box_in_the_room_hides_what_lies_behind_it() -> None:
    camera = load_scene("webcam-plane").true_cameras()["left"]
    hidden = (6, 4)
    there = seen().point[4 * 13 + 6]
    middle = 0.5 * (camera.centre + there)
    box = f"{{kind: box, centre_mm: {middle.tolist()}, size_mm: [5, 5, 5]}}"
    assert numbers(seen(f"occluders=[{box}]")) == {hidden}
    assert numbers(seen(f"occluders=[{box}]", camera="right")) == set()
    beyond = camera.centre + 1.3 * (there - camera.centre)
    box = f"{{kind: box, centre_mm: {beyond.tolist()}, size_mm: [50, 50, 50]}}"
    assert numbers(seen(f"occluders=[{box}]")) == set()


@pytest.mark.parametrize("share", [0.9, 1.1])
def test_a_rod_hides_a_dot_whose_edge_it_touches(share: float) -> None:
    # A thin rod lies along y, on the board, beside the dots of a column: at 0.9 or 1.1 of their radius.
    x = 4 * 700 / 12 + share * 15.0 + 1.0
    rod = f"{{kind: rod, frame: target, from_mm: [{x}, 60, 1], to_mm: [{x}, 440, 1], diameter_mm: 2}}"
    expected = {(4, row) for row in range(1, 6)} if share < 1 else set()
    # The left camera looks along +x on this column, so that a rod of 2 mm height casts no shade on it.
    assert numbers(seen(f"occluders=[{rod}]")) == expected


def test_a_thin_rod_across_a_dot_hides_it() -> None:
    y = 3 * 700 / 9
    rod = f"{{kind: rod, frame: target, from_mm: [-40, {y}, 2], to_mm: [740, {y}, 2], diameter_mm: 1.5}}"
    assert numbers(seen(f"occluders=[{rod}]")) == {(col, 3) for col in range(13)}


def test_a_lamp_in_the_way_hides_dots() -> None:
    camera = load_scene("webcam-plane").true_cameras()["left"]
    middle = 0.5 * (camera.centre + seen().point[4 * 13 + 6])
    lamp = f"{{centre_mm: {middle.tolist()}, look_at_mm: [1000, 1000, 200], size_mm: [5, 5], radiance: 9}}"
    assert numbers(seen(f"lamps=[{lamp}]")) == {(6, 4)}


def test_a_bulge_hides_what_lies_behind_it() -> None:
    low = (
        "cameras.left.eye_mm=[-700, 1000, 320]",
        "cameras.left.look_at_mm=[1000, 1000, 200]",
        "cameras.left.up=[0, 0, 1]",
        "cameras.left.focal_px=500",
        "cameras.left.lens=pinhole",
        "cameras.left.dist=[]",
    )
    assert numbers(seen(*low)) == set()
    bulge = seen(*low, "board.bend.along_x_mm=-60")
    gone = {col for col, _ in numbers(bulge)}
    # Beyond the middle the surface falls away: at a from the middle by 120 a / half, half = 400 mm.
    camera_slope = (320 - 200) / 1700
    assert gone == set(range(min(gone), 13))
    first = min(gone)
    falls = 2 * 60 / 400 * (first * 700 / 12 + 15 - 350) / 400
    assert falls > 0.5 * camera_slope
    assert 6 < first < 10


def test_points_and_pictures_of_a_misprinted_board_are_the_true_ones() -> None:
    flat = seen()
    wrong = seen("board.print_scale=[1.01, 1]", "board.misplacement_mm=0.2", "board.bend.twist_mm=5")
    off = wrong.point - flat.point
    assert 1.0 < np.abs(off[:, 0]).max() < 5.0  # 1% of 350 mm and a little
    assert np.abs(off[:, 1]).max() < 1.0
    assert 3.0 < np.abs(off[:, 2]).max() < 5.0
    camera = load_scene("webcam-plane").true_cameras()["left"]
    np.testing.assert_allclose(wrong.centre, camera.project(wrong.point).q, rtol=0, atol=1e-9)
