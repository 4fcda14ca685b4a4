"""Tests of what more views, tilts and places would bring, on simulated shoots."""

from dataclasses import replace

import numpy as np
import pytest

from labcal.bench.diagnose.held_shoot import Hand, HeldShoot, good_shoot
from labcal.bench.diagnose.mistakes import mixed_sizes
from labcal.bench.diagnose.simulated_dots import simulated_dots
from labcal.geometry.poses import transform
from labcal.guide.diagnosis.check_name import CheckName
from labcal.guide.diagnosis.evidence import Evidence
from labcal.guide.diagnosis.finding import Finding, NotJudged
from labcal.guide.diagnosis.registry import run_check
from labcal.guide.diagnosis.support.frontal import change_of_scale
from labcal.guide.diagnosis.support.judged_support import WORTH

_SUPPORT = (CheckName.TOO_FEW_VIEWS, CheckName.TOO_LITTLE_TILT, CheckName.POOR_COVERAGE)


def _evidence(shoot: HeldShoot) -> Evidence:
    return Evidence(shoot.described, simulated_dots(shoot, np.random.default_rng(2)))


def _shoot(views: int, hand: Hand | None = None) -> HeldShoot:
    shoot = good_shoot("narrow", "rings", views, np.random.default_rng(1), hand)
    return replace(shoot, noise_px=0.03)


def _found(evidence: Evidence, check: CheckName) -> tuple[Finding, ...]:
    result = run_check(check, evidence)
    assert not isinstance(result, NotJudged)
    return result


def test_a_good_shoot_lacks_nothing() -> None:
    evidence = _evidence(_shoot(7))
    assert [_found(evidence, check) for check in _SUPPORT] == [(), (), ()]


def test_frontal_views_at_one_distance_lack_tilt_and_nothing_else() -> None:
    evidence = _evidence(_shoot(7, Hand(tilt=0.06, depth=0.02)))
    (tilt,) = _found(evidence, CheckName.TOO_LITTLE_TILT)
    assert tilt.harm_percent is not None
    assert tilt.harm_percent > 100.0 * WORTH
    assert _found(evidence, CheckName.TOO_FEW_VIEWS) == ()
    assert _found(evidence, CheckName.POOR_COVERAGE) == ()


def test_two_views_are_too_few() -> None:
    (few,) = _found(_evidence(_shoot(2)), CheckName.TOO_FEW_VIEWS)
    assert few.harm_percent == float("inf")
    assert "2 views" in few.words


def test_pictures_of_mixed_sizes_are_named() -> None:
    shoot = _shoot(6)
    dots = mixed_sizes(simulated_dots(shoot, np.random.default_rng(2)), 0.5, np.random.default_rng(3))
    (mixed,) = _found(Evidence(shoot.described, dots), CheckName.MIXED_SIZES)
    assert "1232 x 1028" in mixed.words
    assert len(mixed.views) == 2


def test_dots_alone_do_not_tell_blur_nor_exposure() -> None:
    evidence = _evidence(_shoot(2))
    for check in (CheckName.BLURRED, CheckName.EXPOSURE):
        assert isinstance(run_check(check, evidence), NotJudged)


@pytest.mark.parametrize("tilt", [0.0, 0.1, 0.4])
def test_scale_changes_over_a_tilted_target(tilt: float) -> None:
    shoot = _shoot(2)
    camera, p = shoot.pair.cameras()[0], shoot.dots - shoot.dots.mean(axis=0)
    T = np.diag([1.0, -1.0, -1.0, 1.0])
    T[:3, :3] = T[:3, :3] @ [[1, 0, 0], [0, np.cos(tilt), -np.sin(tilt)], [0, np.sin(tilt), np.cos(tilt)]]
    T[2, 3] = 1200.0
    radius = np.linalg.norm(p, axis=1).max()
    found = change_of_scale(camera.project(transform(T, p)).q, p)
    assert found == pytest.approx(2.0 * radius / 1200.0 * np.sin(tilt), abs=0.004)
