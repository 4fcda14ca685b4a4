"""Medians that are found faster than NumPy's."""

import numpy as np

from labcal.detect.medians import median_of, medians_along
from labcal.rng import generator


def test_medians_are_the_same_numbers_as_those_of_numpy() -> None:
    random = generator(0, "test", "medians")
    for count in range(1, 40):
        values = random.normal(size=count)
        stack = random.normal(size=(count, 2, 2))
        assert median_of(values) == np.median(values)
        np.testing.assert_array_equal(medians_along(stack), np.median(stack, axis=0))
        assert median_of(stack) == np.median(stack)


def test_the_median_of_nan_is_nan() -> None:
    assert np.isnan(median_of(np.array([1.0, np.nan, 2.0])))
