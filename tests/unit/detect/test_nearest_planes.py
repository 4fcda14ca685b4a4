"""Planes through the levels of the nearest places."""

import numpy as np

from labcal.detect.nearest_planes import nearest_planes


def test_planes_are_those_of_least_squares_through_the_nearest_places() -> None:
    random = np.random.default_rng(0)
    place, level = random.uniform(0.0, 500.0, (60, 2)), random.normal(5.0, 0.1, 60)
    slopes, variance = nearest_planes(place, level, 13, 1e-3)
    for i in range(60):
        near = np.argsort(((place - place[i]) ** 2).sum(axis=1))[:13]
        design = np.concatenate([place[near] - place[near].mean(axis=0), np.ones((13, 1))], axis=1)
        found, left, _, _ = np.linalg.lstsq(design, level[near], rcond=None)
        np.testing.assert_allclose(slopes[i], found[:2], rtol=1e-9, atol=1e-15)
        covariance = float(left[0]) / 10.0 * np.linalg.inv(design.T @ design)
        np.testing.assert_allclose(variance[i], np.trace(covariance[:2, :2]), rtol=1e-9)


def test_places_on_one_line_do_not_tell_a_slope() -> None:
    place = np.stack([np.arange(20.0), 2.0 * np.arange(20.0)], axis=1)
    slopes, variance = nearest_planes(place, np.arange(20.0), 5, 1e-3)
    assert not slopes.any()
    assert np.isinf(variance).all()
