"""Pictures that are too dark beside others."""

from pathlib import Path

import numpy as np
import pytest

from labcal.bench.diagnose.drawn_shoot import Fault, drawn_shoot
from labcal.bench.diagnose.held_shoot import good_shoot
from labcal.correspond.measure import detections_of
from labcal.guide.diagnosis.checks import exposure
from labcal.guide.diagnosis.evidence import Evidence


@pytest.mark.parametrize(
    ("stops", "named"), [(-1.7, True), pytest.param(-0.4, False, marks=pytest.mark.slow)]
)
def test_darkness_that_costs_noise_is_named_above_the_level_of_dark_pictures(
    tmp_path: Path, stops: float, *, named: bool
) -> None:
    shoot = good_shoot("webcam", "plain", 4, np.random.default_rng(22))
    fault = Fault("left", frozenset(shoot.views), stops=stops)
    measured = drawn_shoot(shoot, fault, tmp_path, np.random.default_rng(22))
    seen = Evidence(shoot.described, detections_of(measured), None, tuple(measured))
    assert not any(look.dark for look in seen.looks if look is not None)
    found = exposure.check(seen)
    assert [one.cameras for one in found] == [("left",)] * named
    for one in found:
        assert "more noise" in one.words
        assert one.harm_percent is not None
        # Photon noise grows with the root of the exposure's loss, by 80%; measured against truth, by 73%.
        assert one.harm_percent == pytest.approx(100.0 * (2.0 ** (-0.5 * stops) - 1.0), abs=20.0)
