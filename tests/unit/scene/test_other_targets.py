"""Targets that are no grids of dots, in the laboratory."""

import json

import numpy as np
import pytest

from labcal.errors import InputError
from labcal.scene.catalogue import load_scene
from labcal.scene.check import check_scene
from labcal.scene.plan import planned_takes
from labcal.scene.print import TruePrint
from labcal.scene.printed import key_indices, steps_mm
from labcal.scene.truth import true_dots
from labcal.scene.views import planned_views
from labcal.targets.board_set import BoardSet
from labcal.targets.catalogue import load_target


@pytest.mark.parametrize("name", ["coded-8x6", "charuco-12x9"])
def test_places_of_any_target_are_true_without_a_renderer(name: str) -> None:
    scene = load_scene("still-handheld", (f"target={name}",))
    check_scene(scene, 0, 1)
    take = planned_takes(scene, planned_views(scene, 0)[:1], 0).takes[0]
    dots = true_dots(scene, TruePrint.of(scene.target, scene.board, 0), take)
    assert dots.visible.all()
    off = np.linalg.norm(dots.centroid - dots.centre, axis=1)
    assert (off == 0.0).all() if name == "charuco-12x9" else (off > 0.0).all()


def test_steps_are_those_of_the_description() -> None:
    assert steps_mm(load_target("coded-8x6")).tolist() == [22.0, 22.0]
    assert steps_mm(load_target("charuco-12x9")).tolist() == [20.0, 20.0]
    assert steps_mm(load_target("asymmetric-4x11")).tolist() == [40.0, 20.0]
    assert key_indices(load_target("coded-8x6")) == ()
    assert len(key_indices(load_target("rings-10x8"))) == 3


@pytest.mark.parametrize(
    ("change", "words"),
    [
        ("board.misplacement_mm=0.01", "misplaced on a grid of dots only"),
        ("mistake=wrong-pitch", "grids of dots only"),
    ],
)
def test_what_takes_a_grid_refuses_others_by_name(change: str, words: str) -> None:
    scene = load_scene("still-handheld", ("target=coded-8x6", change))
    with pytest.raises(InputError, match=words):
        check_scene(scene, 0, 1)


A = {"kind": "charuco", "name": "a", "squares": [7, 5], "square_mm": 20.0, "marker_mm": 15.0,
     "dictionary": "DICT_4X4_100"}  # fmt: skip
B = {"kind": "chessboard", "name": "b", "cols": 8, "rows": 5, "square_mm": 16.0}
SIDE_BY_SIDE = f"target=[{json.dumps(A)}, {json.dumps(B)}]"


def test_boards_side_by_side_stand_in_a_scene() -> None:
    held = ("placement.visible_share=0.3", "placement.all_rings=off")
    scene = load_scene("still-handheld", (SIDE_BY_SIDE, *held))
    assert isinstance(scene.target, BoardSet)
    assert scene.target.names == ("a", "b")
    assert load_scene("still-handheld", ("target=[charuco-12x9]",)).target == load_target("charuco-12x9")
    take = planned_takes(scene, planned_views(scene, 0)[:1], 0).takes[0]
    dots = true_dots(scene, TruePrint.of(scene.target, scene.board, 0), take)
    assert len(dots.visible) == 6 * 4 + 8 * 5
    assert steps_mm(scene.target).tolist() == [20.0, 20.0]
    keys = key_indices(scene.target)
    assert set(keys) == {(24 + n, 0) for n in range(40)}  # a chessboard without marks must be seen whole


def test_boards_of_a_scene_are_on_one_sheet() -> None:
    whole = {"kind": "boards", "name": "plate", "targets": [A, B]}
    for change, words in (
        ({"mounting": "separate"}, "hold|separately"),
        ({"places": _places([300.0, 0.0, 5.0])}, "do not lie in one plane"),
        ({"places": _places([30.0, 0.0, 0.0])}, "lie on one another"),
        ({"targets": [A, {**WHITE, "name": "w"}]}, "white on black"),
    ):
        with pytest.raises(InputError, match=words):
            load_scene("still-handheld", (f"target={json.dumps({**whole, **change})}",))
    with pytest.raises(InputError, match=r"set 2 times.*'target=\[charuco-12x9, coded-8x6\]'"):
        load_scene("still-handheld", ("target=charuco-12x9", "target=coded-8x6"))


WHITE = {"cols": 6, "rows": 5, "pitch_x_mm": 20.0, "pitch_y_mm": 20.0, "dot_diameter_mm": 8.0,
         "ring_outer_diameter_mm": 12.0, "ring_inner_diameter_mm": 5.0, "polarity": "white-on-black",
         "rings": {"origin": [1, 1], "x": [4, 1], "y": [1, 3]}, "margin_mm": 15.0}  # fmt: skip


def _places(shift: list[float]) -> list[dict[str, object]]:
    T = np.eye(4)
    T[:3, 3] = shift
    return [{"T_set_board": np.eye(4).tolist()}, {"T_set_board": T.tolist()}]
