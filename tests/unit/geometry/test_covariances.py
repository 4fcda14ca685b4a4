import numpy as np

from labcal.geometry.covariances import positive_definite


def test_only_what_can_be_inverted_passes() -> None:
    full = np.array([[2.0, 1.0], [1.0, 2.0]])
    flat = np.array([[1.0, 1.0], [1.0, 1.0]])
    indefinite = np.array([[1.0, 2.0], [2.0, 1.0]])
    cases = np.stack([full, flat, indefinite, -full, 0 * full, np.full((2, 2), np.nan), 1e-12 * full])
    found = positive_definite(cases)
    np.testing.assert_array_equal(found, [True, False, False, False, False, False, True])
    assert np.isfinite(np.linalg.inv(cases[found])).all()


def test_none_is_none() -> None:
    assert positive_definite(np.zeros((0, 4, 3, 3))).shape == (0, 4)
