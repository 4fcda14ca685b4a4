"""Faults in a scene of the laboratory: its exact pixels are those of the fault on simulated points."""

import numpy as np
import pytest

from labcal.bench.faults.faulty_scene import faulty_scene
from labcal.bench.faults.planned_planes import PlannedPlanes
from labcal.bench.faults.registry import FAULT_KINDS, fault_named
from labcal.errors import InputError
from labcal.geometry.poses import transform
from labcal.scene.catalogue import load_scene
from labcal.scene.model import Scene
from labcal.scene.plan import built_scene, planned_takes
from labcal.scene.print import TruePrint
from labcal.scene.views import planned_views

SEED, VIEWS = 6, 4
SCENE = load_scene("still-volume")


def pixels(scene: Scene) -> np.ndarray:
    """Return the exact pixels of the dots in the training views, (n, cameras, 2)."""
    views = planned_views(scene, SEED)[:VIEWS]
    made = TruePrint.of(built_scene(scene).target, scene.board, SEED)
    q = np.stack([take.project(made.centres).q for take in planned_takes(scene, views, SEED).takes])
    by_view = q.reshape(VIEWS, 2, -1, 2).transpose(0, 2, 1, 3)
    return np.ascontiguousarray(by_view.reshape(-1, 2, 2))


def simulated(name: str) -> np.ndarray:
    """Return the pixels of the benchmark's fault, given the same cameras and places."""
    fault = fault_named(name)
    views = planned_views(SCENE, SEED)[:VIEWS]
    declared = np.concatenate([transform(view.T_world_target, SCENE.target.points()) for view in views])
    first, second = SCENE.true_cameras().values()
    return fault.kind.images(PlannedPlanes.of(declared, (first, second), SEED), fault.size)


@pytest.mark.parametrize(
    "name",
    [
        "pitch-0.002", "bend-1.5", "misprint-0.2", "swapped-cameras", "board-turned", "wrong-pitch-0.5",
        "camera-knocked-0.3",
    ],
)  # fmt: skip
def test_a_fault_moves_dots_as_in_the_laboratory(name: str) -> None:
    q = pixels(faulty_scene(SCENE, fault_named(name)))
    assert np.nanmax(np.abs(q - pixels(SCENE))) > 0.1
    assert np.nanmax(np.abs(q - simulated(name))) < 1e-6


def test_what_acts_on_pictures_only_is_in_the_scene() -> None:
    scene = faulty_scene(SCENE, fault_named("out-of-focus-0.5"))
    assert (scene.mistake, scene.mistake_size) == ("out-of-focus", 0.5)
    assert np.array_equal(pixels(scene), pixels(SCENE), equal_nan=True)


def test_every_fault_but_that_of_the_stage_can_be_rendered() -> None:
    for name in FAULT_KINDS:
        if name == "stage":
            with pytest.raises(InputError, match="its stage is exact"):
                faulty_scene(SCENE, fault_named(name))
        else:
            assert faulty_scene(SCENE, fault_named(name)) != SCENE
    with pytest.raises(InputError, match="has the mistake 'wrong-pitch' already"):
        faulty_scene(faulty_scene(SCENE, fault_named("pitch")), fault_named("bend"))
