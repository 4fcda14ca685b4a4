"""The scale of a print by the sizes of its dots."""

from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

from labcal.bench.diagnose.drawn_shoot import Fault, drawn_shoot
from labcal.bench.diagnose.held_shoot import HeldShoot, good_shoot
from labcal.correspond.measure import detections_of
from labcal.guide.diagnosis.check_name import CheckName
from labcal.guide.diagnosis.checks import wrong_pitch
from labcal.guide.diagnosis.dot_scale import DotScale
from labcal.guide.diagnosis.evidence import Evidence
from labcal.guide.diagnosis.finding import NotJudged


def shoot(pitch: float, diameter: float) -> HeldShoot:
    """Return a shoot of a print of which pitch and diameter are multiples of the declared ones."""
    good = good_shoot("webcam", "plain", 6, np.random.default_rng(11))
    printed = good.printed.model_copy(
        update={
            "pitch_x_mm": pitch * good.printed.pitch_x_mm,
            "pitch_y_mm": pitch * good.printed.pitch_y_mm,
            "dot_diameter_mm": diameter * good.printed.dot_diameter_mm,
        }
    )
    return replace(good, printed=printed, dots=printed.points())


def evidence(made: HeldShoot, folder: Path) -> Evidence:
    """Return the evidence of a shoot with pictures."""
    measured = drawn_shoot(made, Fault(), folder, np.random.default_rng(12))
    return Evidence(made.described, detections_of(measured), None, tuple(measured))


def test_a_pitch_that_is_wrong_alike_along_both_sides_is_told_by_the_dots(tmp_path: Path) -> None:
    seen = evidence(shoot(1.05, 1.0), tmp_path)
    found = DotScale.of(seen)
    assert found is not None
    assert abs(found.ratio - 1.0 / 1.05) < 3.0 * found.sigma
    assert found.sigma < 0.005
    (finding,) = wrong_pitch.check(seen)
    assert finding.check is CheckName.WRONG_PITCH
    assert "diameter" in finding.words
    assert finding.harm_percent > 100.0


@pytest.mark.slow
def test_a_print_whose_ink_has_spread_is_not_accused(tmp_path: Path) -> None:
    seen = evidence(shoot(1.0, 1.01), tmp_path)
    found = DotScale.of(seen)
    assert found is not None
    assert abs(found.ratio - 1.01) < 3.0 * found.sigma
    assert isinstance(wrong_pitch.check(seen), NotJudged)
    assert DotScale.of(replace(seen, measurements=())) is None
