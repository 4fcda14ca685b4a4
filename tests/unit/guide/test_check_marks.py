"""Checks of a simulated pair by marks that stay where they are."""

import sys
from functools import cache
from pathlib import Path

import numpy as np
import pytest

sys.path.insert(0, str(Path(__file__).parent))

from simulated_pair import KIND, NOISE_PX, one, rig

from labcal import NamedPixels, NamedPoints
from labcal.calibrate.adjustment.state import RigState
from labcal.calibrate.validity.change import Change, ChangeKind, changes_in_room
from labcal.calibrate.validity.room import in_room
from labcal.cameras.camera import Camera
from labcal.errors import InputError
from labcal.geometry.poses import transform
from labcal.guide.checking import checked_by_marks
from labcal.guide.rig_check import CheckVerdict, RigCheck
from labcal.reconstruct.named_points import reconstruct_named
from labcal.rng import generator

MARKS = KIND.points(20, generator(0, "marks"))


def pixels(cameras: tuple[Camera, ...], p: np.ndarray, seed: int) -> NamedPixels:
    q = np.concatenate([camera.project(p).q for camera in cameras])
    names = [f"m{number}" for number in range(len(p))]
    noise = NOISE_PX * generator(seed, "pixels of marks").standard_normal(q.shape)
    covariance = np.tile(NOISE_PX**2 * np.eye(2), (len(q), 1, 1))
    return NamedPixels(
        ["now"] * len(q), ["left"] * len(p) + ["right"] * len(p), names * 2, q + noise, covariance
    )


@cache
def places() -> NamedPoints:
    return reconstruct_named(rig(), pixels(KIND.cameras(), MARKS, 0)).points


def seen(change: Change | None, size: list[float], seed: int = 1) -> RigCheck:
    state = RigState(KIND.cameras(), np.eye(4)[None], MARKS)
    state = state if change is None else change.applied(state, np.array(size))
    return checked_by_marks(
        rig(), pixels(state.cameras, transform(state.T_world_target[0], MARKS), seed), places()
    )


def test_a_rig_as_it_was_is_found_as_it_was() -> None:
    found = seen(None, [])
    assert found.verdict is not CheckVerdict.CHANGED
    assert (found.camera, found.cost, found.warnings) == (None, None, ())
    assert 0.7 < found.sigma0 < 1.3


@pytest.mark.slow
def test_p_values_of_a_rig_as_it_was_are_those_of_chance() -> None:
    gains = []
    for seed in range(2, 32):
        test = seen(None, [], seed).tested
        gains += [test.unchanged.cost - one.cost for one in test.changed if one.change.count == 3]
    # Each is a chi-square of three degrees of freedom, shared by tests of one check.
    assert np.mean(gains) == pytest.approx(3.0, abs=4.0 * np.sqrt(6.0 / 30))


@pytest.mark.parametrize("camera", [0, pytest.param(1, marks=pytest.mark.slow)])
def test_marks_tell_which_camera_was_shifted(camera: int) -> None:
    found = seen(one("shifted", camera), [0.4, 0.3, -0.2])
    assert (found.verdict, found.camera) == (CheckVerdict.CHANGED, ("left", "right")[camera])
    assert found.changes[0].kind is ChangeKind.SHIFTED
    (amount,) = found.changes[0].amounts
    assert (np.abs(np.array(amount.value) - [0.4, 0.3, -0.2]) < 4.0 * np.array(amount.sigma)).all()
    assert found.cost is not None
    assert found.mended().covariance is not None


def test_a_rig_that_was_moved_as_one_body_needs_no_correction() -> None:
    together = next(one for one in changes_in_room((1, 2)) if one.kind is ChangeKind.TOGETHER)
    state = RigState(in_room(KIND.cameras()), np.eye(4)[None], MARKS)
    moved = together.applied(state, np.array([0.002, 0.001, -0.001, 0.5, -1.0, 0.3])).cameras[1:]
    found = checked_by_marks(rig(), pixels(moved, MARKS, 1), places())
    assert (found.verdict, found.camera) == (CheckVerdict.CHANGED, None)
    assert found.changes[0].kind is ChangeKind.TOGETHER
    assert found.cost is not None
    assert found.cost.max_mm < 1e-6
    with pytest.raises(InputError, match="nothing is to be corrected"):
        found.mended()


def test_a_mark_that_moved_itself_is_left_out_by_name() -> None:
    p = MARKS.copy()
    p[3] += [3.0, 2.0, -1.0]
    found = checked_by_marks(rig(), pixels(KIND.cameras(), p, 1), places())
    assert found.verdict is not CheckVerdict.CHANGED
    assert any("m3" in warning for warning in found.warnings)


def test_wrong_input_says_what_to_do() -> None:
    few = pixels(KIND.cameras(), MARKS[:3], 1)
    with pytest.raises(InputError, match="sees 3 marks of known place; a check needs 4"):
        checked_by_marks(rig(), few, places())
    bare = pixels(KIND.cameras(), MARKS, 1)
    bare = NamedPixels(bare.view, bare.camera, bare.point, bare.position)
    with pytest.raises(InputError, match="a test needs their noise"):
        checked_by_marks(rig(), bare, places())
    unusable = places()
    unusable = NamedPoints(
        unusable.view, unusable.name, unusable.point, unusable.covariance, ["model-misfit"] * len(unusable)
    )
    with pytest.raises(InputError, match="No place of a mark is usable"):
        checked_by_marks(rig(), pixels(KIND.cameras(), MARKS, 1), unusable)
