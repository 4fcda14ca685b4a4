"""The update by one light against the textbook's: conditioning of joint normal variables."""

import numpy as np

from labcal.detect.edges.one_light import OneLight
from labcal.detect.edges.residuals import (
    COLUMNS,
    COVARIANCE,
    SLOPE_DIFFERENCE,
    SLOPE_DIFFERENCE_COVARIANCE,
)
from labcal.detect.stage_settings.edge import EdgeSettings

COUNT = 40


def fits() -> tuple[np.ndarray, np.ndarray]:
    """Return a table of fits and the joint covariances of centre and slope difference, (n, 4, 4)."""
    rng = np.random.default_rng(3)
    roots = rng.normal(0, 1, (COUNT, 4, 6))
    joint = roots @ np.swapaxes(roots, 1, 2)
    table = np.zeros((COUNT, COLUMNS))
    drawn = np.einsum("nij,nj->ni", np.linalg.cholesky(joint), rng.normal(0, 1, (COUNT, 4)))
    table[:, :2], table[:, SLOPE_DIFFERENCE : SLOPE_DIFFERENCE + 2] = drawn[:, :2], drawn[:, 2:]
    table[:, COVARIANCE : COVARIANCE + 3] = joint[:, [0, 0, 1], [0, 1, 1]]
    first = SLOPE_DIFFERENCE_COVARIANCE
    table[:, first : first + 3] = joint[:, [2, 2, 3], [2, 3, 3]]
    table[:, first + 3 : first + 7] = joint[:, [0, 0, 1, 1], [2, 3, 2, 3]]
    return table, joint


def test_with_the_noise_that_chose_the_gain_it_is_conditioning() -> None:
    table, joint = fits()
    light = OneLight.of(table, 2.0, EdgeSettings())
    C = 2.0 * joint
    C[:, 2:, 2:] += light.scatter * np.eye(2)
    gain = C[:, :2, 2:] @ np.linalg.inv(C[:, 2:, 2:])
    np.testing.assert_allclose(light.covariances(table, 2.0), C[:, :2, :2] - gain @ C[:, 2:, :2], atol=1e-9)
    off = table[:, SLOPE_DIFFERENCE : SLOPE_DIFFERENCE + 2]
    np.testing.assert_allclose(
        light.centres(table), table[:, :2] - np.einsum("nij,nj->ni", gain, off), atol=1e-9
    )


def test_with_other_noise_it_is_that_of_the_weighted_sum() -> None:
    table, joint = fits()
    light = OneLight.of(table, 2.0, EdgeSettings())
    together = np.concatenate([np.tile(np.eye(2), (COUNT, 1, 1)), -light.gain], axis=2)
    expected = 0.3 * together @ joint @ np.swapaxes(together, 1, 2)
    expected += light.scatter * light.gain @ np.swapaxes(light.gain, 1, 2)
    covariance = light.covariances(table, 0.3)
    np.testing.assert_allclose(covariance, expected, atol=1e-9)
    assert (np.linalg.eigvalsh(covariance) > 0).all()
