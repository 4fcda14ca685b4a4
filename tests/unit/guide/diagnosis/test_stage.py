"""Mistakes on a stage: a board that lies turned, and a pitch that its readings contradict."""

import numpy as np
import pytest

from labcal import Detections
from labcal.arrays import Pose
from labcal.bench.diagnose.held_shoot import HeldShoot, Picture, good_shoot
from labcal.bench.diagnose.simulated_dots import simulated_dots
from labcal.geometry.poses import from_rotation_vector, pose
from labcal.guide.diagnosis.check_name import CheckName
from labcal.guide.diagnosis.checks import turned_target, wrong_pitch
from labcal.guide.diagnosis.evidence import Evidence
from labcal.guide.diagnosis.finding import Finding
from labcal.guide.diagnosis.stage_scale import StageScale
from labcal.scene.catalogue import load_scene
from labcal.scene.plan import planned_takes
from labcal.scene.views import planned_views

SCENE = load_scene("webcam-volume")
TAKES = planned_takes(SCENE, planned_views(SCENE, 0), 0).takes


def dots(factor: float = 1.0, turned: str = "", seed: int = 0) -> Detections:
    """Return the dots of a shoot on a stage; printed with another pitch, or turned in a view."""
    like = good_shoot("webcam", "rings", 3, np.random.default_rng(0))
    points = SCENE.grid.points()
    turn = from_rotation_vector(np.array([0.0, 0.0, np.pi]), np.zeros(3))
    middle = points.mean(axis=0)
    about = pose(np.eye(3), middle) @ turn @ pose(np.eye(3), -middle)
    pictures = [
        Picture(
            take.view,
            take.camera,
            take.device,
            take.track.T_world_target @ (about if take.view == turned else np.eye(4)),
            np.zeros(3),
        )
        for take in TAKES
    ]
    shoot = HeldShoot(like.kind, SCENE.grid, SCENE.grid, factor * points, tuple(pictures), 0.03)
    return simulated_dots(shoot, np.random.default_rng(seed))


def evidence(of: Detections) -> Evidence:
    """Return the evidence with the readings of the stage."""
    found = Evidence(SCENE.grid, of)
    nominal: dict[str, Pose] = {take.view: take.track.T_world_target for take in TAKES}
    vars(found)["nominal_poses"] = nominal  # in the place of a shoot's
    return found


@pytest.mark.slow
def test_the_scale_of_the_print_is_found_within_its_uncertainty() -> None:
    scores = []
    for seed, factor in enumerate((1.0, 1.0, 1.001)):
        found = StageScale.of(evidence(dots(factor, seed=seed)))
        assert found is not None
        assert found.sigma < 2e-4
        scores.append((found.ratio - factor) / found.sigma)
    assert np.abs(scores).max() < 5.0


@pytest.mark.parametrize(
    ("factor", "named"), [(1.02, True), pytest.param(1.0, False, marks=pytest.mark.slow)]
)
def test_a_wrong_pitch_is_named_by_the_readings(factor: float, *, named: bool) -> None:
    found = wrong_pitch.check(evidence(dots(factor)))
    assert isinstance(found, tuple)
    assert [one.check for one in found] == [CheckName.WRONG_PITCH] * named
    if named:
        assert found[0].words.startswith("The stage's readings say that the pitch differs")
        assert "+2 +-" in found[0].words


@pytest.mark.parametrize("view", ["", "train-3"])
def test_a_board_that_lies_turned_in_one_view_is_named(view: str) -> None:
    found = turned_target.check(evidence(dots(turned=view)))
    assert isinstance(found, tuple)
    views = [one.views for one in found if isinstance(one, Finding)]
    assert views == ([(view,)] if view else [])
