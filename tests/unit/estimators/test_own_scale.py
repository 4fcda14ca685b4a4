"""Scale of what a method states of its own errors."""

from collections.abc import Callable

import numpy as np
import pytest

from labcal.estimators.dlt import Dlt
from labcal.estimators.own_scale import own_scale
from labcal.estimators.two_plane import TwoPlane
from labcal.evaluate.statistics import coverage

View = Callable[[np.ndarray], np.ndarray]
NOISE = np.diag([1.0, 2.0, 4.0])
OWN = np.array([[2.0, 0.5, 0.0], [0.5, 1.0, 0.3], [0.0, 0.3, 3.0]])
N = 4000


def drawn(own: np.ndarray, noise: np.ndarray = NOISE, n: int = N) -> np.ndarray:
    """Return normal errors whose covariance is that of noise and another one."""
    return np.random.default_rng(5).multivariate_normal(np.zeros(3), noise + own, n)


@pytest.mark.parametrize("factor", [0.3, 1.0, 30.0, 1e4])
def test_the_true_factor_is_found(factor: float) -> None:
    error = drawn(factor * OWN)
    stated = np.tile(NOISE, (N, 1, 1)), np.tile(OWN, (N, 1, 1))
    found = own_scale(error, *stated, 0.95)
    assert 0.75 < found / factor < 1.33
    assert abs(coverage(error, stated[0] + found * stated[1]) - 0.95) < 0.005


def test_what_noise_hides_is_left_as_it_is() -> None:
    """Of an error of a hundredth of the noise, 4,000 points do not tell the size."""
    own = 1e-4 * np.tile(OWN, (N, 1, 1))
    assert 0.4 < own_scale(drawn(0.0 * OWN), np.tile(NOISE, (N, 1, 1)), own, 0.95) < 2.5


def test_a_method_that_knows_no_noise_is_scaled_as_a_whole() -> None:
    none = np.zeros((N, 3, 3))
    assert own_scale(drawn(9.0 * OWN, none[0]), none, np.tile(OWN, (N, 1, 1)), 0.95) == pytest.approx(
        9.0, rel=0.05
    )


def test_a_few_errors_change_nothing() -> None:
    few = slice(0, 50)
    none = np.tile(NOISE, (N, 1, 1))[few]
    assert own_scale(100.0 * drawn(OWN)[few], none, none, 0.95) == 1.0


def test_errors_that_are_not_finite_do_not_count() -> None:
    error = drawn(4.0 * OWN)
    stated = np.tile(NOISE, (N, 1, 1)), np.tile(OWN, (N, 1, 1))
    lost = error.copy()
    lost[::2] = np.nan
    assert own_scale(lost, *stated, 0.95) == own_scale(error[1::2], stated[0][1::2], stated[1][1::2], 0.95)


@pytest.mark.parametrize("method", [Dlt, TwoPlane])
@pytest.mark.parametrize("factor", [0.04, 6.0])
def test_a_fitted_method_that_is_too_sure_or_too_careful_is_put_right(
    method: type[Dlt | TwoPlane], factor: float, stereo: View, volume: np.ndarray
) -> None:
    """Twenty points leave parameters uncertain; what they err by is then told too small, or too large."""
    random, sigma = np.random.default_rng(7), 0.5
    noisy = stereo(volume) + sigma * random.standard_normal((len(volume), 4))
    fitted = method(**({"degree": 2} if method is TwoPlane else {})).fit(noisy[:20], volume[:20])
    fitted.gain_ = factor * fitted.gain_
    low, high = volume[:20].min(axis=0), volume[:20].max(axis=0)
    covered = []
    for calibrated in (False, True):
        p = random.uniform(low, high, (3000, 3))
        X = stereo(p) + sigma * random.standard_normal((len(p), 4))
        covariance = np.tile(sigma**2 * np.eye(2), (len(p), 2, 1, 1))
        points, stated = fitted.predict_with_covariance(X, covariance)
        covered.append(coverage(points - p, stated))
        if not calibrated:
            fitted.calibrate_covariance(X, covariance, p)
    assert abs(covered[0] - 0.95) > 0.02
    assert abs(covered[1] - 0.95) < 0.015
    assert (factor < 1.0) == (fitted.own_scale_ > 1.0)


def test_fitting_again_forgets_the_scale(stereo: View, volume: np.ndarray) -> None:
    fitted = Dlt().fit(stereo(volume), volume)
    fitted.own_scale_ = 7.0
    assert fitted.fit(stereo(volume), volume).own_scale_ == 1.0
