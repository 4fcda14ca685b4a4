"""What the benchmark of the bundle adjustment measures with."""

from dataclasses import replace

import numpy as np
import pytest

from labcal.bench.solve.adjustment import measured_growth
from labcal.bench.solve.corruption import corruption_checks
from labcal.bench.solve.halves import disagreement, halves
from labcal.bench.solve.held_rig import CAMERAS, NOISE_PX, TARGET, HeldRig
from labcal.calibrate.handheld import HandheldSettings, calibrate_handheld


def test_a_held_rig_is_measured_with_its_noise_and_starts_off() -> None:
    held = HeldRig.drawn(4, seed=1)
    residual = held.truth.residuals(held.observations)
    assert len(residual) == 2 * 4 * TARGET.count
    assert residual.std() == pytest.approx(NOISE_PX, rel=0.1)
    assert np.abs(held.start(1).residuals(held.observations)).max() > 20 * NOISE_PX
    table = held.detections()
    assert (table.cameras, len(table.views)) == (CAMERAS, 4)
    np.testing.assert_array_equal(table.position, np.float32(table.position))


def test_growth_is_measured_for_every_size() -> None:
    growth = measured_growth((2, 4), seed=1)
    assert len(growth.seconds) == 2
    assert min(growth.seconds) > 0.0
    assert 0.01 < growth.peak_gib < 64.0


def test_halves_of_a_sound_rig_agree_and_of_a_changed_one_do_not() -> None:
    dots = HeldRig.drawn(8, seed=2).detections()
    settings = HandheldSettings(eccentricity_rounds=0)
    one, other = (calibrate_handheld(half, TARGET, "brown5", settings) for half in halves(dots))
    assert [len(half.views) for half in halves(dots)] == [4, 4]
    apart = disagreement(one, other)
    assert apart.shape == (2 * 9 + 6,)
    assert 0.2 < np.sqrt((apart**2).mean()) < 2.0
    np.testing.assert_array_equal(disagreement(one, one), 0.0)
    half = halves(dots)[1]
    shifted = replace(half, position=half.position + np.array([20.0, 0.0]))
    assert np.abs(disagreement(one, calibrate_handheld(shifted, TARGET, "brown5", settings))).max() > 3.0


def test_wrong_dots_and_pictures_are_found() -> None:
    assert all(check.ok for check in corruption_checks(0))
