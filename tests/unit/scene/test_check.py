import pytest

from labcal.errors import InputError
from labcal.scene.catalogue import load_scene
from labcal.scene.check import check_scene


@pytest.mark.parametrize(
    ("overrides", "what"),
    [
        (("cameras.left.dist=[-0.9, 0, 0, 0, 0]",), "folds within its picture"),
        (("cameras.left.size=[30000, 30000]",), "megapixels"),
        (("cameras.right.look_at_mm=[1000, 1010, 4000]",), "behind camera 'right'"),
        (("cameras.right.eye_mm=[1285, 630, -700]",), "back of the target"),
        (("cameras.right.eye_mm=[1285, 630, -1000]",), "under the floor"),
        (("cameras.right.eye_mm=[1285, 9999, 1800]",), "behind the wall"),
        (("cameras.left.focal_px=2500",), r"the ring at \(2, 2\)"),
        (("placement.views.1.origin_mm=[1650, 650, 200]",), "In view 'test-shifted'"),
        (
            ("lamps=[{centre_mm: [0, 0, -600], look_at_mm: [0, 0, 0], size_mm: [9, 9], radiance: 9}]",),
            "No lamp",
        ),
        (("lamps.0.centre_mm=[1000, 1000, 200]",), "away from itself"),
        (("cameras.left.look_at_mm=[720, 640, 1850]",), "away from itself"),
        (
            ("lamps.1.centre_mm=[0, 2100, 900]",),
            r"lamps.1 at \(0, 2100, 900\) mm is under the floor or behind",
        ),
        (("lamps.1.centre_mm=[1000, 1000, -80]",), "lamps.1 at .* is inside the table"),
        (("lamps.1.centre_mm=[1000, 1000, 100]",), "lamps.1 at .* is inside the target's support"),
        (("cameras.left.eye_mm=[1600, 1400, -80]",), "Camera 'left' at .* is inside the table"),
        (("placement.views.1.origin_mm=[650, 1400, 200]",), "corner of the target in view 'test-shifted'"),
        (("room.floor_z_mm=250",), "corner of the target in view 'train'"),
        (("occluders=[{kind: box, centre_mm: [720, 640, 1850], size_mm: [9, 9, 9]}]",), "inside occluders.0"),
        (
            ("occluders=[{kind: rod, from_mm: [720, 640, 1800], to_mm: [720, 640, 1900], diameter_mm: 9}]",),
            "inside occluders.0",
        ),
        (
            (
                "occluders=[{kind: box, frame: target, centre_mm: [350, 350, 20], size_mm: [700, 700, 10]}]",
                "board.misplacement_mm=0.1",
            ),
            r"the ring at \(2, 2\) is hidden from camera 'left' by occluders.0",
        ),
        (("board.misplacement_mm=20",), "half a pitch off"),
        (("board.print_scale=[1.2, 1]",), "does not fit on its board"),
    ],
)
def test_what_cannot_be_rendered_is_named(overrides: tuple[str, ...], what: str) -> None:
    with pytest.raises(InputError, match=what):
        check_scene(load_scene("webcam-plane", overrides), seed=0)
