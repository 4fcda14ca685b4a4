"""Tests of many errors at once: good ones pass them, and errors half as large again do not."""

import numpy as np

from labcal.bench.solve.joint_errors import (
    chance_of_mean,
    median_sigmas,
    most_mean_square,
    most_sigmas,
    within_three_sigmas,
)

PARAMETERS, BENCHES = 240, 4000


def test_good_errors_pass_and_larger_ones_do_not() -> None:
    errors = np.random.default_rng(1).standard_normal((BENCHES, PARAMETERS))
    for size, passes in ((1.0, True), (1.5, False)):
        mean_square = (size * errors**2 * size).mean(axis=1)
        worst = np.abs(size * errors).max(axis=1)
        for value, most in ((mean_square, most_mean_square(PARAMETERS)), (worst, most_sigmas(PARAMETERS))):
            failed = float((value > most).mean())
            # 0.005 of the good ones, with a standard error of 0.0011
            assert failed < 0.009 if passes else failed > 0.5


def test_the_worst_error_of_many_is_beyond_three_deviations_in_half_of_the_cases() -> None:
    errors = np.random.default_rng(2).standard_normal((BENCHES, PARAMETERS))
    share = float((np.abs(errors).max(axis=1) > median_sigmas(PARAMETERS)).mean())
    assert abs(share - 0.5) < 3.3 * 0.5 / np.sqrt(BENCHES)
    assert median_sigmas(PARAMETERS) > 2.9


def test_correlated_errors_have_no_larger_maxima() -> None:
    random = np.random.default_rng(3)
    errors = 0.8 * random.standard_normal((BENCHES, 1)) + 0.6 * random.standard_normal((BENCHES, PARAMETERS))
    assert float((np.abs(errors).max(axis=1) > most_sigmas(PARAMETERS)).mean()) < 0.009


def test_a_set_within_three_deviations_is_judged_by_all_parameters_together() -> None:
    assert within_three_sigmas(8.99, 1)
    assert not within_three_sigmas(9.01, 1)
    assert within_three_sigmas(1.9, 24)
    assert not within_three_sigmas(2.1, 24)


def test_means_of_few_sets_are_granted_more_chance() -> None:
    means = np.random.default_rng(4).standard_normal((BENCHES, 3))
    off = means.mean(axis=1) / (means.std(axis=1, ddof=1) / np.sqrt(3.0))
    assert abs(float((off > chance_of_mean(3)).mean()) - 0.005) < 3.3 * np.sqrt(0.005 / BENCHES)
    assert chance_of_mean(2) > chance_of_mean(3) > chance_of_mean(16) > 2.6
