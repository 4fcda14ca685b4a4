"""Errors that dots of a view share, against simulated sets of which they are known."""

from dataclasses import replace
from functools import cache

import numpy as np
import pytest
from scipy.stats import chi2

from labcal.calibrate.adjustment.rounds import adjust_in_rounds
from labcal.calibrate.budget.correlated_errors import CorrelatedErrors
from labcal.calibrate.budget.entered import Entered
from labcal.calibrate.budget.error_patterns import ErrorPatterns
from labcal.calibrate.budget.error_sources import ErrorSources
from tests.unit.calibrate.budget.test_joint_covariance import FIXED, TARGET, Simulated, drawn

SETS = 6
SMOOTH_PX, WHOLE_PX = 0.05, 0.1


def patterns() -> ErrorPatterns:
    return ErrorPatterns.of(TARGET.points(), np.arange(TARGET.count), 2)


@cache
def disturbed(seed: int, kind: str) -> Simulated:
    """Return a set with errors of a kind added to its white noise."""
    one = drawn(seed, 0.0, 8)
    rng = np.random.default_rng([17, seed])
    q = one.observations.q.copy()
    for picture in one.observations.pictures:
        if kind == "smooth":
            factor = patterns().smooth
            q[picture.rows] += SMOOTH_PX * factor @ rng.standard_normal((factor.shape[1], 2))
        elif kind == "whole":
            q[picture.rows] += WHOLE_PX * patterns().affine @ rng.standard_normal((3, 2))
    observations = replace(one.observations, q=q)
    adjusted = adjust_in_rounds(one.adjusted.state, observations, FIXED, np.ones(TARGET.count), 0)
    return Simulated(one.truth, adjusted, observations, ErrorSources.of(adjusted, observations, None))


@cache
def errors(kind: str) -> tuple[CorrelatedErrors, ...]:
    found = (disturbed(seed, kind) for seed in range(SETS))
    return tuple(CorrelatedErrors.of(Entered.of(one.adjusted, one.observations)) for one in found)


def test_patterns_have_one_unit_of_variance() -> None:
    square = (patterns().smooth ** 2).sum(axis=1)
    assert square.mean() == pytest.approx(1.0)
    assert patterns().affine[:, 1:].mean(axis=0) == pytest.approx([0.0, 0.0], abs=1e-12)


@pytest.mark.slow
def test_white_noise_shows_no_correlated_errors() -> None:
    found = [one.components for one in errors("none")]
    assert np.mean([one.white for one in found]) == pytest.approx(1.0, abs=0.05)
    for one in found:
        assert (one.variance < 4.0 * one.sigma + 1e-12).all()
    assert np.median([one.smooth_px for one in errors("none")]) < 0.2 * SMOOTH_PX


def test_sizes_of_smooth_errors_are_found() -> None:
    found = np.array([one.components.variance[0] for one in errors("smooth")])
    sigma = np.array([one.components.sigma[0] for one in errors("smooth")])
    off = (found.mean() - SMOOTH_PX**2) / (np.sqrt(SETS) * sigma.mean() / SETS)
    assert abs(off) < 3.3
    assert found.std() == pytest.approx(sigma.mean(), rel=0.8)


@pytest.mark.slow
def test_shifts_of_pictures_that_poses_have_absorbed_are_found() -> None:
    """Poses take up most of what moves a picture: what they left tells the variance of all of it."""
    found = np.array([one.components.variance[2] for one in errors("whole")])
    spread = found.std() / np.sqrt(SETS)
    assert abs(found.mean() - WHOLE_PX**2) < 3.3 * spread


def test_cameras_scatter_as_stated_where_errors_are_smooth() -> None:
    found = [disturbed(seed, "smooth") for seed in range(SETS)]
    assert all(one.sources.correlated is not None for one in found)
    count = len(found[0].covariance)
    low, high = chi2.ppf([5e-4, 0.9995], SETS * count)
    total = sum(one.square(one.covariance) for one in found)
    assert 0.7 * low < total < high  # stated one standard error wide
    independent = sum(one.square(one.adjusted.spread[:count, :count]) for one in found)
    assert independent > 2.0 * high


def test_views_that_agree_have_none() -> None:
    assert drawn(0, 0.0, 8).sources.correlated is None
