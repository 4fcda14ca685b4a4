import pytest

from labcal.errors import InputError
from labcal.scene.catalogue import load_scene
from labcal.scene.check import check_scene


@pytest.mark.parametrize(
    ("overrides", "what"),
    [
        (("cameras.left.dist=[-0.9, 0, 0, 0, 0]",), "folds within its picture"),
        (("cameras.left.size=[1000000, 1000000]",), "megapixels"),
        (("cameras.right.look_at_mm=[1000, 1010, 4000]",), "behind camera 'right'"),
        (("cameras.right.eye_mm=[1285, 630, -700]",), "back of the target"),
        (("cameras.right.eye_mm=[1285, 630, -1000]",), "under the floor"),
        (("cameras.right.eye_mm=[1285, 9999, 1800]",), "behind the wall"),
        (("cameras.left.focal_px=2500",), r"the ring at \(2, 2\)"),
        (("placement.views.1.origin_mm=[1650, 650, 200]",), "In view 'test-shifted'"),
        (("lamps.0.centre_mm=[0, 0, -600]", "lamps.1.centre_mm=[0, 0, -600]"), "No lamp"),
        (("lamps.0.centre_mm=[1000, 1000, 200]",), "away from itself"),
        (("cameras.left.look_at_mm=[720, 640, 1850]",), "away from itself"),
    ],
)
def test_what_cannot_be_rendered_is_named(overrides: tuple[str, ...], what: str) -> None:
    with pytest.raises(InputError, match=what):
        check_scene(load_scene("webcam-plane", overrides), seed=0)
