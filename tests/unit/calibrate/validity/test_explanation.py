import numpy as np

from labcal.calibrate.validity.explanation import covariance_root


def test_a_root_of_a_singular_covariance_in_any_units() -> None:
    random = np.random.default_rng(0)
    J = random.standard_normal((5, 3)) * np.array([1e-6, 1.0, 40.0, 0.0, 1e3])[:, None]
    R = covariance_root(J @ J.T)
    assert R.shape[1] == 3
    np.testing.assert_allclose(R @ R.T, J @ J.T, rtol=1e-9, atol=1e-18)
