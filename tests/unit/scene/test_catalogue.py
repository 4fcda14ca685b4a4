from pathlib import Path

import pytest

from labcal.errors import InputError
from labcal.scene.catalogue import load_scene, scene_names
from labcal.scene.check import check_scene
from labcal.shoot.manifest import Role


def test_the_seven_scenes_are_shipped() -> None:
    assert scene_names() == [
        "still-handheld",
        "still-plane",
        "still-positions",
        "still-volume",
        "webcam-handheld",
        "webcam-plane",
        "webcam-volume",
    ]


@pytest.mark.parametrize("name", scene_names())
def test_every_scene_can_be_rendered(name: str) -> None:
    scene = load_scene(name)
    assert scene.name == name
    assert scene.target.name == "paper-13x10"
    check_scene(scene, seed=0)


def test_off_is_false_and_nested_values_are_set() -> None:
    scene = load_scene(
        "webcam-plane",
        ("noise=off", "cameras.left.focal_px=512", "placement.views.1.name=other", "target=rings-10x8"),
    )
    assert scene.noise is False
    assert scene.cameras["left"].focal_px == 512.0
    assert scene.cameras["right"].focal_px == load_scene("webcam-plane").cameras["right"].focal_px
    assert scene.placement.views[1].name == "other"
    assert scene.target.name == "rings-10x8"


def test_keys_left_at_their_default_can_be_set() -> None:
    assert (
        load_scene("webcam-plane", ("room.tile_mm=250", "board.dark=[0.1, 0.1, 0.1]")).room.tile_mm == 250.0
    )


@pytest.mark.parametrize(
    ("override", "offered"),
    [
        ("nois=off", "'noise'"),
        ("cameras.left.focal=5", "'cameras.left.focal_px'"),
        ("cameras.lefty.focal_px=5", "'cameras.left'"),
        ("placement.views.7.name=x", "placement.views.1"),
        ("target=paper-13x11", "'paper-13x10'"),
    ],
)
def test_a_wrong_name_is_answered_with_the_nearest(override: str, offered: str) -> None:
    with pytest.raises(InputError, match=r"There is no (key|target)") as caught:
        load_scene("webcam-plane", (override,))
    assert offered in str(caught.value)


@pytest.mark.parametrize(
    ("override", "what"),
    [
        ("noise", "key=value"),
        ("noise=[", "not valid YAML"),
        ("noise=perhaps", "noise"),
        ("spp=0", "spp"),
        ("photometry.read_noise_e=-1", "read_noise_e"),
        ("spp.more=1", "single value"),
        ("cameras.left.lens=fish", "fish"),
    ],
)
def test_a_value_that_cannot_be_is_named(override: str, what: str) -> None:
    with pytest.raises(InputError) as caught:
        check_scene(load_scene("webcam-plane", (override,)), seed=0)
    assert what in str(caught.value)


def test_an_unknown_key_in_a_file_is_named(tmp_path: Path) -> None:
    text = load_scene("webcam-plane").to_yaml() + "colour: red\n"
    path = tmp_path / "mine.yaml"
    path.write_text(text)
    with pytest.raises(InputError, match="colour: this key is not known"):
        load_scene(str(path))


def test_a_scene_survives_its_own_yaml(tmp_path: Path) -> None:
    scene = load_scene("still-handheld", ("spp=128",))
    path = tmp_path / "mine.yaml"
    path.write_text(scene.to_yaml())
    assert load_scene(str(path)) == scene


def test_train_and_test_views_are_as_the_paper_has_them() -> None:
    volume = load_scene("webcam-volume").placement
    heights = {
        role: [view.origin_mm[2] for view in volume.views if view.role is role]
        for role in (Role.TRAIN, Role.TEST)
    }
    assert heights[Role.TRAIN] == pytest.approx([0.0, 1000 / 3, 2000 / 3, 1000.0])
    assert heights[Role.TEST] == pytest.approx([500 / 3, 500.0, 2500 / 3, 1000 / 3])
    assert all(
        view.shift_pitches == ((0.5, 0.5) if view.role is Role.TEST else (0.0, 0.0)) for view in volume.views
    )
