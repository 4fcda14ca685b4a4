"""Sizes of functions whose answer is known."""

import math

import pytest

from labcal.paper.explanations.size import PRECISION, size_giving

SIZES = (0.1, 1.0, 10.0, 100.0)


@pytest.mark.parametrize(
    ("error_at", "size"),
    [
        (lambda s: 3.0 * s, 7.0),
        (lambda s: 0.02 * s**2, math.sqrt(21.0 / 0.02)),
        (lambda s: 20.0 + math.log10(s), 10.0),
    ],
)
def test_the_size_is_where_the_error_is_the_target(error_at, size: float) -> None:  # noqa: ANN001 -- a function
    assert size_giving(21.0, error_at, SIZES) == pytest.approx(size, rel=2 * PRECISION)


def test_a_jump_is_found() -> None:
    found = size_giving(1.0, lambda s: 0.0 if s < 33.0 else 5.0, SIZES)
    assert found == pytest.approx(33.0, rel=2 * PRECISION)


def test_the_first_size_that_is_enough_of_an_error_that_falls_again() -> None:
    found = size_giving(1.0, lambda s: 2.0 * s if s <= 10.0 else 0.1, SIZES)
    assert found == pytest.approx(0.5, rel=2 * PRECISION)


def test_no_size_is_a_result() -> None:
    assert size_giving(1.0, lambda s: s / 101.0, SIZES) is None
    assert size_giving(1.0, lambda _: math.nan, SIZES) is None


def test_the_least_size_where_it_is_more_than_enough() -> None:
    assert size_giving(1.0, lambda s: 100.0 * s, SIZES) == SIZES[0]


def test_a_size_without_an_error_is_passed_over() -> None:
    found = size_giving(1.0, lambda s: math.nan if s < 2.0 else s / 5.0, SIZES)
    assert found == pytest.approx(5.0, rel=2 * PRECISION)
