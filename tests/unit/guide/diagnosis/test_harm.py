"""What a mistake is said to cost is of the order of what it costs; `calibrate` does not contradict it."""

import numpy as np
import pytest

from labcal.bench.diagnose.harm import LENS, measured_error
from labcal.bench.diagnose.held_shoot import good_shoot
from labcal.bench.diagnose.mistakes import MISTAKES
from labcal.bench.diagnose.simulated_dots import simulated_dots
from labcal.calibrate.agreement.finding import ContradictionError
from labcal.calibrate.handheld import calibrate_handheld
from labcal.guide.diagnosis.check_name import CheckName
from labcal.guide.diagnosis.diagnosing import diagnosed
from labcal.guide.diagnosis.evidence import Evidence


@pytest.mark.slow
@pytest.mark.parametrize(
    ("kind", "check", "size"),
    [
        ("webcam", CheckName.CAMERA_MOVED, 0.07),
        ("narrow", CheckName.CAMERA_MOVED, 0.016),
        ("webcam", CheckName.BENT_BOARD, 1.7),
    ],
)
def test_the_stated_harm_is_within_a_factor_of_two(kind: str, check: CheckName, size: float) -> None:
    good = good_shoot(kind, "rings", 14, np.random.default_rng(1))
    bad = MISTAKES[check](good, size, np.random.default_rng(8))
    dots = simulated_dots(bad, np.random.default_rng(6))
    without = measured_error(good, simulated_dots(good, np.random.default_rng(6)), np.random.default_rng(9))
    times = measured_error(good, dots, np.random.default_rng(9)) / without
    first = diagnosed(Evidence(good.described, dots)).findings[0]
    assert first.check is check
    assert first.harm_percent is not None
    assert 0.5 < (1.0 + first.harm_percent / 100.0) / times < 2.0


@pytest.mark.parametrize(("check", "size"), [(CheckName.CAMERA_MOVED, 0.5), (CheckName.UNSYNCHRONISED, 5.0)])
def test_calibrate_names_the_same_cause(check: CheckName, size: float) -> None:
    good = good_shoot("webcam", "rings", 10, np.random.default_rng(1))
    dots = simulated_dots(MISTAKES[check](good, size, np.random.default_rng(8)), np.random.default_rng(6))
    try:
        doubt = calibrate_handheld(dots, good.described, LENS).disagreement
    except ContradictionError as error:
        doubt = error.disagreement
    assert doubt is not None
    assert doubt.causes[0].cause.value == check.value
    assert diagnosed(Evidence(good.described, dots)).findings[0].check is check
