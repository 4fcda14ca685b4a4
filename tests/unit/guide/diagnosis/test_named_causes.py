"""Warnings of a calibration name the mistakes that a diagnosis names, in its words."""

import numpy as np
import pytest

from labcal.bench.diagnose.held_shoot import good_shoot
from labcal.bench.diagnose.mistakes import MISTAKES
from labcal.bench.diagnose.simulated_dots import simulated_dots
from labcal.calibrate.calibrated import calibrated
from labcal.guide.diagnosis.check_name import CheckName
from labcal.guide.diagnosis.named_causes import OF_GEOMETRY
from labcal.pipeline import FitSettings, calibrate, diagnose, training_of

GOOD = good_shoot("narrow", "rings", 12, np.random.default_rng(0))


@pytest.mark.slow
def test_calibrate_fit_and_diagnose_name_a_moved_camera_in_the_same_words() -> None:
    random = np.random.default_rng(1)
    moved = simulated_dots(MISTAKES[CheckName.CAMERA_MOVED](GOOD, 0.05, random), random)
    (first, *_) = diagnose(moved, GOOD.described).findings
    assert first.check is CheckName.CAMERA_MOVED
    words = f"1. camera-moved: {first.words} {first.mend}"
    made = calibrate(GOOD.described, moved, "brown5")
    assert words in made.warnings
    assert made.found.disagreement is not None
    assert made.found.disagreement.causes[0].views == first.views
    before = calibrated(moved, GOOD.described, "brown5")
    assert made.rig == before.rig
    assert before.found.disagreement is not None
    replaced = {f"{n}. {one.cause}: {one.why}" for n, one in enumerate(before.found.disagreement.causes, 1)}
    assert replaced
    assert not replaced.intersection(made.warnings)
    training = training_of(GOOD.described, moved, FitSettings(lens="brown5"))
    assert words in training.warnings


def test_checks_of_geometry_are_causes_of_contradictions_by_the_same_names() -> None:
    from labcal.calibrate.agreement.finding import CauseName  # noqa: PLC0415 -- beside its use

    assert {one.value for one in OF_GEOMETRY} <= {one.value for one in CauseName}
