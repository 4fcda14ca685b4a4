"""The covariance that is expected of planned views, against the one that a calibration of them states."""

import numpy as np

from labcal import examples
from labcal.bench.solve.rehearsal_set import simulated_dots
from labcal.calibrate.budget.expected_covariance import ExpectedCovariance
from labcal.calibrate.handheld import HandheldSettings, calibrate_handheld
from labcal.guide.rehearsal.dot_noise import DotNoise
from labcal.guide.rehearsal.planned_rig import PlannedRig

PLANNED = PlannedRig.of(examples.rig_plan())
NOISE = DotNoise(8.0, 0.02**2, -1.0)


def relative(found: np.ndarray, expected: np.ndarray) -> np.ndarray:
    """Return found variances along the axes of the expected covariance, in units of the expected ones."""
    scale = np.sqrt(np.diagonal(expected))
    spread, axes = np.linalg.eigh(expected / np.outer(scale, scale))
    along = axes.T @ (found / np.outer(scale, scale)) @ axes
    return np.asarray(np.diagonal(along) / spread)


def test_a_calibration_states_the_covariance_that_was_expected() -> None:
    views = PLANNED.views(8, 0)
    expected = ExpectedCovariance.of_declared(PLANNED.state(views), PLANNED.observations(views, NOISE), 0.0)
    assert (expected.print_share == 0.0).all()
    dots = simulated_dots(PLANNED, views, PLANNED.plan.target.points(), NOISE, np.random.default_rng(0))
    made = calibrate_handheld(dots, PLANNED.plan.target, "brown-k1k2", HandheldSettings())
    stated = made.covariance.covariance  # without what the lens model may lack
    np.testing.assert_allclose(relative(stated, expected.total), 1.0, atol=0.25)


def test_the_share_of_the_print_is_that_of_the_adjustment() -> None:
    views = PLANNED.views(8, 0)
    sigma = 0.05
    expected = ExpectedCovariance.of_declared(PLANNED.state(views), PLANNED.observations(views, NOISE), sigma)
    random = np.random.default_rng(0)
    places = PLANNED.plan.target.points()
    places[:, :2] += sigma * random.standard_normal((len(places), 2))
    dots = simulated_dots(PLANNED, views, places, NOISE, random)
    made = calibrate_handheld(
        dots, PLANNED.plan.target, "brown-k1k2", HandheldSettings(dot_places="declared")
    )
    assert made.sources.print_share is not None
    ratio = np.diagonal(made.sources.print_share.covariance) / np.diagonal(expected.print_share)
    factor = (made.sources.print_sigma_mm / sigma) ** 2
    np.testing.assert_allclose(ratio / factor, 1.0, atol=0.3)


def test_freed_dots_leave_of_the_print_its_scale_alone() -> None:
    views = PLANNED.views(10, 0)
    state, observations = PLANNED.state(views), PLANNED.observations(views, NOISE)
    declared = ExpectedCovariance.of_declared(state, observations, 0.05)
    freed = ExpectedCovariance.of_freed(state, observations, 0.05)
    assert np.trace(freed.print_share[-3:, -3:]) < 0.2 * np.trace(declared.print_share[-3:, -3:])
    assert (np.diagonal(freed.noise) > 0.99 * np.diagonal(
        ExpectedCovariance.of_declared(state, observations, 0.0).noise)).all()  # fmt: skip
