"""The update by one light, summed dot by dot, is the Kalman update in matrices."""

import numpy as np

from labcal.detect.edges.light_sums import gains, updated_centres, updated_covariances
from labcal.detect.edges.residuals import COLUMNS, COVARIANCE, SLOPE_DIFFERENCE, SLOPE_DIFFERENCE_COVARIANCE

FACTOR, SCATTER = 1.7, 0.03


def test_gain_centre_and_josephs_form() -> None:
    random = np.random.default_rng(2)
    table = random.normal(size=(5, COLUMNS))
    found, centre, covariance = [], [], []
    for row in table:
        root = random.normal(size=(4, 4))
        both = root @ root.T + np.eye(4)  # of the centre and the difference
        own, noise, shared = both[:2, :2], both[2:, 2:], both[:2, 2:]
        row[COVARIANCE : COVARIANCE + 3] = own[0, 0], own[0, 1], own[1, 1]
        start = SLOPE_DIFFERENCE_COVARIANCE
        row[start : start + 7] = noise[0, 0], noise[0, 1], noise[1, 1], *shared.ravel()
        gain = FACTOR * shared @ np.linalg.inv(FACTOR * noise + SCATTER * np.eye(2))
        found.append(gain)
        centre.append(row[:2] - gain @ row[SLOPE_DIFFERENCE : SLOPE_DIFFERENCE + 2])
        joseph = own - gain @ shared.T - shared @ gain.T + gain @ noise @ gain.T
        covariance.append(FACTOR * joseph + SCATTER * gain @ gain.T)
    gain = gains(table, FACTOR, SCATTER)
    np.testing.assert_allclose(gain, found, rtol=1e-9)
    np.testing.assert_allclose(updated_centres(table, gain), centre, rtol=1e-9)
    np.testing.assert_allclose(updated_covariances(table, gain, FACTOR, SCATTER), covariance, rtol=1e-9)
