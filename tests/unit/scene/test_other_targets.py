"""Targets that are no grids of dots, in the laboratory."""

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
