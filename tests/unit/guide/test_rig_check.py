"""Checks of a simulated pair whose change is known."""

import sys
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

sys.path.insert(0, str(Path(__file__).parent))

from simulated_pair import KIND, NOISE_PX, TARGET, one, rig, seen

from labcal import Detections
from labcal.bench.solve.pair_dots import pair_dots
from labcal.calibrate.adjustment.state import RigState
from labcal.calibrate.handheld import HandheldSettings, calibrate_handheld
from labcal.calibrate.validity.change import ChangeKind
from labcal.cameras.camera import Camera
from labcal.correspond.gathering import joined
from labcal.distributions import gain_tail, needed_gain
from labcal.errors import InputError
from labcal.geometry.poses import from_rotation_vector, pose
from labcal.guide.checking import checked
from labcal.guide.rig_check import CheckVerdict


@pytest.mark.slow
def test_rigs_as_they_were_have_p_values_of_chance() -> None:
    p = [checked(rig(), seen(None, [], seed=seed), TARGET).p_value for seed in range(10)]
    assert min(p) > 0.01


def test_a_rig_as_it_was_is_valid() -> None:
    first = checked(rig(), seen(None, []), TARGET)
    assert (first.verdict, first.camera, first.cost, first.warnings) == (CheckVerdict.VALID, None, None, ())
    assert first.undetected_mm < first.budget_mm
    assert 0.9 < first.sigma0 < 1.1


@pytest.mark.parametrize("camera", [0, pytest.param(1, marks=pytest.mark.slow)])
@pytest.mark.parametrize(("kind", "size"), [("turned", [2e-4, -8e-4, 9e-4]), ("refocused", [-0.002])])
def test_a_turn_and_a_refocus_are_of_the_camera_that_they_are_of(
    kind: str, size: list[float], camera: int
) -> None:
    found = checked(rig(), seen(one(kind, camera), size, seed=3), TARGET)
    assert found.verdict is CheckVerdict.CHANGED
    assert found.camera == ("left", "right")[camera]
    assert found.changes[0].kind.value == kind
    (amount,) = found.changes[0].amounts
    true = np.array(size) * (180.0 / np.pi if kind == "turned" else 100.0)
    assert (np.abs(amount.value - true) < 4.0 * np.array(amount.sigma)).all()
    assert found.cost is not None
    assert found.cost.max_mm >= found.cost.rms_mm > 0.0


def test_which_camera_was_shifted_is_said_not_to_be_told() -> None:
    found = checked(rig(), seen(one("shifted", 0), [0.4, 0.3, -0.2]), TARGET)
    assert (found.verdict, found.camera) == (CheckVerdict.CHANGED, None)
    assert found.changes[0].kind is ChangeKind.SHIFTED
    assert found.changes[0].cameras == ("left", "right")
    assert "it cannot be determined which" in found.changes[0].words
    np.testing.assert_allclose(list(found.by_camera.values()), 0.5, atol=0.01)
    assert found.changes[0].amounts[0].size == pytest.approx(np.linalg.norm([0.4, 0.3, 0.2]), abs=0.1)


@pytest.mark.slow
@pytest.mark.parametrize(("kind", "size"), [("shifted", [0.4, 0.3, -0.2]), ("refocused", [0.004])])
def test_a_mended_rig_is_valid(kind: str, size: list[float]) -> None:
    change = one(kind, 1)
    mended = checked(rig(), seen(change, size), TARGET).mended()
    again = checked(mended, seen(change, size, seed=7), TARGET)
    assert again.verdict is CheckVerdict.VALID
    assert mended.covariance is not None
    assert mended.calibrated_on == (*rig().calibrated_on, "view-00", "view-01", "view-02")
    assert checked(rig(), seen(change, size, seed=7), TARGET).verdict is CheckVerdict.CHANGED


def test_what_does_not_support_a_correction_is_refused() -> None:
    with pytest.raises(InputError, match="there is no change to correct"):
        checked(rig(), seen(None, []), TARGET).mended()
    found = checked(rig(), seen(one("shifted", 1), [1.0, 0.0, 0.0], views=2), TARGET)
    assert "only 2 views entered" in found.warnings[0]
    with pytest.raises(InputError, match="2 views cannot correct a rig"):
        found.mended()


def test_one_dot_far_off_is_left_out() -> None:
    dots = seen(None, [])
    position = dots.position.copy()
    position[40] += [4.0, -3.0]
    found = checked(rig(), replace(dots, position=position), TARGET)
    assert (found.verdict, found.outliers) == (CheckVerdict.VALID, 1)


def test_noise_that_is_larger_than_stated_is_no_change_but_a_warning() -> None:
    dots = seen(None, [])
    extra = 0.3 * np.random.default_rng(5).standard_normal(dots.position.shape)
    found = checked(rig(), replace(dots, position=dots.position + extra), TARGET)
    assert found.verdict is CheckVerdict.VALID
    assert found.sigma0 == pytest.approx(np.hypot(NOISE_PX, 0.3) / NOISE_PX, rel=0.1)
    assert any("times what the calibration predicts" in warning for warning in found.warnings)


def test_wrong_input_says_what_to_do() -> None:
    bare = rig().model_copy(update={"covariance": None})
    with pytest.raises(InputError, match="Calibrate again"):
        checked(bare, seen(None, []), TARGET)
    dots = seen(None, [])
    with pytest.raises(InputError, match="the rig has left, right"):
        checked(rig(), replace(dots, camera=np.where(dots.camera == "left", "top", dots.camera)), TARGET)
    with pytest.raises(InputError, match="same size"):
        checked(rig(), replace(dots, size=dots.size // 2), TARGET)
    used = replace(dots, view=np.char.add("cal-", dots.view.astype(str)))
    assert "no check of it" in " ".join(checked(rig(), used, TARGET).warnings)


@pytest.mark.parametrize("noise_freedom", [float("inf"), 7.0])
def test_the_gain_that_is_needed_is_found_as_often_as_said(noise_freedom: float) -> None:
    random, n = np.random.default_rng(1), 20_000
    gain = needed_gain(0.002, 3, noise_freedom, 0.9)
    found = random.noncentral_chisquare(3, gain, n)
    if np.isfinite(noise_freedom):
        found = found / (random.chisquare(noise_freedom, n) / noise_freedom)
    share = np.mean([gain_tail(value, 3, noise_freedom) <= 0.002 for value in found])
    assert share == pytest.approx(0.9, abs=4.0 * np.sqrt(0.09 / n))


@pytest.mark.slow
def test_of_three_cameras_the_one_that_was_shifted_is_named() -> None:
    left, right = KIND.cameras()
    place = from_rotation_vector(np.array([0.0, -0.25, 0.0]), np.zeros(3)) @ pose(
        np.eye(3), np.array([250.0, 0.0, 0.0])
    )
    third = replace(left, T_cam_world=place)
    random = np.random.default_rng(8)

    def dots(cameras: tuple[Camera, ...], T: np.ndarray) -> Detections:
        views, noise = list(T), (NOISE_PX, random)
        pair = pair_dots(cameras[:2], TARGET, TARGET.points(), views, noise)
        last = pair_dots((cameras[2], cameras[2]), TARGET, TARGET.points(), views, noise)
        last = last.where(last.camera == "left")
        return joined([pair, replace(last, camera=np.full(len(last), "third"))])

    def poses(count: int) -> np.ndarray:
        return np.array(KIND.poses(count, random))

    cameras = (left, right, third)
    settings = HandheldSettings(eccentricity_rounds=0)
    made = calibrate_handheld(dots(cameras, poses(12)), TARGET, "brown5", settings).rig
    state = RigState(cameras, poses(3), TARGET.points())
    moved = one("shifted", 1).applied(state, np.array([0.4, 0.3, -0.2]))
    found = checked(made, dots(moved.cameras, moved.T_world_target), TARGET)
    assert (found.verdict, found.camera) == (CheckVerdict.CHANGED, "right")
    assert found.changes[0].kind is ChangeKind.SHIFTED
    assert found.plot().axes[0].get_title().startswith("changed")
