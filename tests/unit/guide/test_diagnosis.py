"""Mistakes of geometry in simulated shoots are named, and good shoots are not accused."""

from dataclasses import replace

import numpy as np
import pytest

from labcal import Detections
from labcal.bench.diagnose.held_shoot import Hand, HeldShoot, good_shoot
from labcal.bench.diagnose.mistakes import MISLABELLED, MISTAKES
from labcal.bench.diagnose.simulated_dots import simulated_dots
from labcal.guide.diagnosis.check_name import CheckName
from labcal.guide.diagnosis.diagnosing import diagnosed
from labcal.guide.diagnosis.diagnosis import Diagnosis
from labcal.guide.diagnosis.evidence import Evidence
from labcal.guide.diagnosis.forms.explaining import explained
from labcal.guide.diagnosis.forms.hypotheses import hypotheses

VIEWS = 12


def shoot(seed: int = 0) -> HeldShoot:
    """Return a good shoot of the narrow pair, of which small mistakes cost much."""
    return good_shoot("narrow", "rings", VIEWS, np.random.default_rng(seed))


def mistaken(check: CheckName, size: float, seed: int = 0) -> tuple[HeldShoot, Detections]:
    """Return a shoot with one mistake, and its dots."""
    random = np.random.default_rng(seed + 1)
    good = shoot(seed)
    if check in MISTAKES:
        return good, simulated_dots(MISTAKES[check](good, size, random), random)
    return good, MISLABELLED[check](simulated_dots(good, random), size, random)


def diagnosis(check: CheckName, size: float) -> Diagnosis:
    """Return the diagnosis of a shoot with one mistake."""
    good, dots = mistaken(check, size)
    return diagnosed(Evidence(good.described, dots))


@pytest.mark.parametrize(
    ("check", "size"),
    [
        (CheckName.SWAPPED_CAMERAS, 0.3),
        (CheckName.TURNED_TARGET, 0.1),
        (CheckName.CAMERA_MOVED, 0.02),
        (CheckName.BENT_BOARD, 0.2),
    ],
)
def test_a_mistake_is_named_first(check: CheckName, size: float) -> None:
    assert diagnosis(check, size).findings[0].check is check


@pytest.mark.slow
@pytest.mark.parametrize(
    ("check", "size"),
    [
        (CheckName.UNSYNCHRONISED, 0.1),
        (CheckName.REFOCUSED, 0.001),
        (CheckName.WRONG_PITCH, 0.001),
        (CheckName.ROLLING_SHUTTER, 0.5),
    ],
)
def test_other_mistakes_are_named_first(check: CheckName, size: float) -> None:
    assert diagnosis(check, size).findings[0].check is check


def test_a_moved_camera_explains_what_looks_unsynchronised() -> None:
    found = diagnosis(CheckName.CAMERA_MOVED, 0.05)
    assert [one.check for one in found.findings] == [CheckName.CAMERA_MOVED]
    signs = {one.check: one.explained_by for one in found.explained}
    assert signs[CheckName.UNSYNCHRONISED] is CheckName.CAMERA_MOVED


def test_a_small_mistake_beside_a_large_one_is_named_second() -> None:
    random = np.random.default_rng(1)
    both = MISTAKES[CheckName.CAMERA_MOVED](shoot(), 0.05, random)
    both = MISTAKES[CheckName.WRONG_PITCH](both, 0.0006, random)
    found = diagnosed(Evidence(both.described, simulated_dots(both, random))).findings
    assert [one.check for one in found] == [CheckName.CAMERA_MOVED, CheckName.WRONG_PITCH]


def test_the_exchanged_views_are_named() -> None:
    good, dots = mistaken(CheckName.SWAPPED_CAMERAS, 0.3)
    untouched = simulated_dots(good, np.random.default_rng(1))
    wrong = {
        view
        for view in dots.views
        if not np.allclose(
            dots.position[(dots.view == view) & (dots.camera == "left")].mean(axis=0),
            untouched.position[(untouched.view == view) & (untouched.camera == "left")].mean(axis=0),
            atol=1.0,
        )
    }
    (labels,) = Evidence(good.described, dots).labels
    assert set(labels.exchanged) == wrong
    assert labels.turned == ()


def test_gains_of_a_good_shoot_follow_chi_square() -> None:
    good = shoot(3)
    evidence = Evidence(good.described, simulated_dots(good, np.random.default_rng(4)))
    model = evidence.model
    assert model is not None
    before = model.fit(())
    noise = model.own_noise(())
    for one in hypotheses(model.forms):
        fit = model.fit(one.terms)
        count, gain = fit.freedom - before.freedom, (before.chi2 - fit.chi2) / noise
        assert gain < count + 5.0 * np.sqrt(2.0 * count) + 5.0, one.check
    assert explained(model).found == ()


def test_an_uneven_print_seen_with_little_tilt_is_no_motion() -> None:
    good = good_shoot("narrow", "rings", 7, np.random.default_rng(5), Hand(tilt=0.1, reach=0.3))
    plane = good.dots[:, :2] - good.dots[:, :2].mean(axis=0)
    x, y = (plane / np.abs(plane).max()).T
    uneven = good.dots + 0.05 * np.stack([x**2 * y, x * y**2 - y**3, np.zeros_like(x)], axis=1)
    dots = simulated_dots(replace(good, dots=uneven), np.random.default_rng(6))
    found = Evidence(good.described, dots).explained
    assert found is not None
    of_shape = {CheckName.BENT_BOARD, CheckName.WRONG_PITCH}
    assert {one.hypothesis.check for one in found.by_themselves} <= of_shape


def test_the_size_of_a_move_is_found() -> None:
    angle = 0.02
    good, dots = mistaken(CheckName.CAMERA_MOVED, angle)
    found = Evidence(good.described, dots).explained
    assert found is not None
    (one,) = found.found
    assert np.degrees(np.linalg.norm(one.size[:3])) == pytest.approx(angle, rel=0.1)


def test_without_a_stage_a_uniform_pitch_is_not_judged() -> None:
    good = shoot()
    found = diagnosed(Evidence(good.described, simulated_dots(good, np.random.default_rng(2))))
    why = {one.check: one.why for one in found.not_judged}
    assert "stage" in why[CheckName.WRONG_PITCH]
