import numpy as np
import pytest

from labcal.errors import InputError
from labcal.run.descriptions import validate_description
from labcal.scene.catalogue import load_scene
from labcal.scene.model import Scene
from labcal.scene.views import planned_views
from labcal.shoot.manifest import Role


def staged(placement: dict[str, object]) -> Scene:
    content = load_scene("webcam-volume").model_dump(mode="json") | {"placement": placement}
    return validate_description(Scene, "scene", "mine", content)


def held(name: str) -> dict[str, object]:
    """A pose of a target in the hand."""
    return {"name": name, "role": "test", "origin_mm": [1.0, 2.0, 30.0], "rotation_rad": [0.0, 0.0, 0.5]}


def test_listed_poses_in_the_hand_are_taken_as_they_are_and_nobody_is_told() -> None:
    first, second = planned_views(
        staged({"kind": "poses", "views": [held("a"), held("b") | {"role": "train"}]}), seed=0
    )
    assert (first.name, first.role, second.role) == ("a", Role.TEST, Role.TRAIN)
    np.testing.assert_array_equal(first.T_world_target[:3, 3], [1.0, 2.0, 30.0])
    np.testing.assert_allclose(first.T_world_target[:2, 0], [np.cos(0.5), np.sin(0.5)])
    assert first.T_world_target_nominal is None


@pytest.mark.parametrize(
    "heights", [[0.0, 1000 / 3, 2000 / 3, 1000.0], {"first": 0.0, "last": 1000.0, "count": 4}]
)
def test_planes_are_those_of_the_paper(heights: object) -> None:
    planes = planned_views(
        staged({"kind": "planes", "origin_mm": [650.0, 650.0], "heights_mm": heights}), seed=0
    )
    listed = planned_views(load_scene("webcam-volume"), seed=0)[:7]  # what follows is no plane between
    assert [view.name for view in planes] == [view.name for view in listed]
    assert [view.role for view in planes] == [view.role for view in listed]
    for ours, theirs in zip(planes, listed, strict=True):
        np.testing.assert_allclose(ours.T_world_target, theirs.T_world_target, atol=1e-9)
        np.testing.assert_array_equal(ours.T_world_target_nominal, ours.T_world_target)


def test_planes_are_taken_at_every_shift_and_tests_lie_between_neighbours() -> None:
    scene = staged(
        {
            "kind": "planes",
            "origin_mm": [650.0, 650.0],
            "heights_mm": [400.0, 0.0, 100.0],
            "shifts_pitches": [[0.0, 0.0], [0.5, -0.25]],
            "test_shifts_pitches": [[0.0, 0.0]],
        }
    )
    views = planned_views(scene, seed=0)
    assert [view.name for view in views] == [
        *("train-1-1", "train-1-2", "train-2-1", "train-2-2", "train-3-1", "train-3-2"),
        *("test-between-1", "test-between-2"),
    ]
    origins = np.array([view.T_world_target[:3, 3] for view in views])
    np.testing.assert_allclose(origins[:, 2], [400, 400, 0, 0, 100, 100, 50, 250])
    pitch = [scene.target.pitch_x_mm, scene.target.pitch_y_mm]
    np.testing.assert_allclose(origins[1, :2] - origins[0, :2], [0.5 * pitch[0], -0.25 * pitch[1]])


def test_a_volume_without_height_may_be_told_with_a_minus() -> None:
    placement = {"kind": "volume", "origin_mm": [650.0, 650.0], "heights_mm": [0.0, -0.0]}
    views = planned_views(staged({**placement, "shift_pitches": [0.5, 0.25], "train": 3, "test": 1}), seed=1)
    assert {view.T_world_target[2, 3] for view in views} == {0.0}


def test_a_volume_is_drawn_evenly_from_the_seed() -> None:
    placement = {
        "kind": "volume",
        "origin_mm": [650.0, 650.0],
        "heights_mm": [100.0, 900.0],
        "shift_pitches": [0.5, 0.25],
        "train": 300,
        "test": 100,
    }
    scene = staged(placement)
    views = planned_views(scene, seed=1)
    assert [view.role for view in views] == [Role.TRAIN] * 300 + [Role.TEST] * 100
    origins = np.array([view.T_world_target[:3, 3] for view in views])
    pitch = np.array([scene.target.pitch_x_mm, scene.target.pitch_y_mm])
    low = np.array([650.0 - 0.5 * pitch[0], 650.0 - 0.25 * pitch[1], 100.0])
    high = np.array([650.0 + 0.5 * pitch[0], 650.0 + 0.25 * pitch[1], 900.0])
    share = (origins - low) / (high - low)
    assert ((share >= 0.0) & (share <= 1.0)).all()
    z = (share.mean(axis=0) - 0.5) / np.sqrt(1.0 / 12.0 / len(share))
    assert (np.abs(z) < 3.5).all()
    squares = ((share - 0.5) ** 2).mean(axis=0)  # 1/12 for a uniform number, whose fourth moment is 1/80
    z = (squares - 1.0 / 12.0) / np.sqrt((1.0 / 80.0 - 1.0 / 144.0) / len(share))
    assert (np.abs(z) < 3.5).all()
    for view in views:
        np.testing.assert_array_equal(view.T_world_target_nominal, view.T_world_target)
    fewer = planned_views(staged(placement | {"train": 2, "test": 1}), seed=1)
    for ours, theirs in zip(fewer, (views[0], views[1], views[300]), strict=True):
        assert ours.name == theirs.name
        np.testing.assert_array_equal(ours.T_world_target, theirs.T_world_target)
    assert not np.array_equal(planned_views(scene, seed=2)[0].T_world_target, views[0].T_world_target)


@pytest.mark.parametrize(
    ("placement", "what"),
    [
        ({"kind": "planes", "origin_mm": [0, 0], "heights_mm": []}, "heights_mm"),
        ({"kind": "planes", "origin_mm": [0, 0], "heights_mm": {"first": 0, "last": 1, "count": 0}}, "count"),
        (
            {"kind": "volume", "origin_mm": [0, 0], "heights_mm": [9, 1], "train": 1, "test": 0},
            "lowest and the highest",
        ),
        ({"kind": "volume", "origin_mm": [0, 0], "heights_mm": [1, 9], "train": 0, "test": 0}, "no views"),
        ({"kind": "stage", "views": []}, "views"),
        ({"kind": "poses", "views": []}, "views"),
        ({"kind": "poses", "views": [held("a"), held("a")]}, "same name"),
        ({"kind": "poses", "views": [held("a"), held("A")]}, "capital letters"),
        ({"kind": "poses", "views": [held("a") | {"rotation_rad": [0.0, 0.1]}]}, "rotation_rad"),
        ({"kind": "tripod"}, "planes"),
    ],
)
def test_what_is_no_placement_is_named(placement: dict[str, object], what: str) -> None:
    with pytest.raises(InputError, match=what):
        staged(placement)
