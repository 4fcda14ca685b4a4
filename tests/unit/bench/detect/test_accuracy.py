import numpy as np

from labcal.bench.detect.accuracy import Errors, accuracy_checks, chi_square_z, over_bound

BOUND = np.array([[4e-5, 1e-5], [1e-5, 2e-5]])


def drawn(n: int, scale: float = 1.0, shift: float = 0.0) -> Errors:
    e = np.random.default_rng(2).multivariate_normal([0.0, 0.0], scale**2 * BOUND, n) + np.array([shift, 0.0])
    bounds = np.tile(BOUND, (n, 1, 1))
    return Errors(e, bounds, bounds, e, e)


def test_errors_at_the_bound_pass_and_know_it() -> None:
    checks = accuracy_checks("dots", drawn(2000), 0.002)
    assert [check.ok for check in checks] == [True, True, True]
    assert abs(checks[0].value - 1.0) < 0.04


def test_larger_errors_miss_the_bound_and_chi_square() -> None:
    assert [check.ok for check in accuracy_checks("dots", drawn(2000, 1.3), 0.002)] == [False, True, False]


def test_errors_smaller_than_stated_fail_chi_square_too() -> None:
    assert [check.ok for check in accuracy_checks("dots", drawn(2000, 0.8), 0.002)] == [True, True, False]


def test_a_shift_fails_the_bias() -> None:
    assert not accuracy_checks("dots", drawn(2000, shift=0.003), 0.002)[1].ok


def test_nothing_measured_is_no_success() -> None:
    none = drawn(3)
    lost = Errors(np.full((3, 2), np.nan), none.covariance, none.bound, none.blob, none.contour)
    assert not any(check.ok for check in accuracy_checks("dots", lost, 0.002))


def test_dots_that_are_not_measured_do_not_count() -> None:
    errors = drawn(500).labcal
    half = errors.copy()
    half[::2] = np.nan
    bounds = np.tile(BOUND, (500, 1, 1))
    np.testing.assert_allclose(over_bound(half, bounds), over_bound(errors[1::2], bounds[1::2]))


def test_chi_square_is_two_sided() -> None:
    assert chi_square_z(1000.0, 1000) < 0.1
    assert chi_square_z(1200.0, 1000) > 3.3
    assert chi_square_z(820.0, 1000) > 3.3
    assert np.isfinite(chi_square_z(1e7, 1000))
