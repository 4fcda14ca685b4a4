"""Sums of many numbers in four parts."""

import numpy as np
import pytest

from labcal.detect.lane_sums import greatest, total, total_of_products


@pytest.mark.parametrize("count", [1, 3, 4, 9, 470])
def test_sums_and_the_greatest_of_any_number_of_values(count: int) -> None:
    random = np.random.default_rng(count)
    values, others = random.normal(size=count), random.normal(size=count + 2)
    assert total(values) == pytest.approx(values.sum(), abs=1e-12)
    assert total_of_products(values, others) == pytest.approx(values @ others[:count], abs=1e-12)
    assert greatest(values) == values.max()


def test_nothing_adds_up_to_nothing() -> None:
    assert total(np.zeros(0)) == 0.0
    assert total_of_products(np.zeros(0), np.zeros(0)) == 0.0
