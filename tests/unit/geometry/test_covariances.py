import numpy as np
import pytest

from labcal.geometry.covariances import (
    clearly_definite,
    covariance_root,
    inverses,
    positive_definite,
    valid_or_not_stated,
)


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


def spread_matrices(dim: int) -> np.ndarray:
    """Return symmetric matrices with eigenvalues of all sizes and signs, and some that are none."""
    rng = np.random.default_rng(dim)
    spread = 10.0 ** rng.uniform(-18, 2, (4000, dim)) * rng.choice([-1, 0, 1], (4000, dim), p=[0.1, 0.1, 0.8])
    Q = np.linalg.qr(rng.standard_normal((4000, dim, dim)))[0]
    A = (Q * spread[:, None, :]) @ Q.swapaxes(1, 2)
    A = 0.5 * (A + A.swapaxes(1, 2))
    A[0], A[1, 0, 0], A[2], A[3, -1, -1] = np.nan, np.nan, np.inf, -np.inf
    return A


@pytest.mark.parametrize("dim", [2, 3])
def test_determinants_and_eigenvalues_decide_alike(dim: int) -> None:
    """What determinants leave no doubt of is not looked at again; nothing else than eigenvalues decides."""
    A = spread_matrices(dim)
    finite = np.isfinite(A).all(axis=(1, 2))
    spread = np.linalg.eigvalsh(A[finite])
    definite = spread[:, 0] > 1e-14 * spread[:, -1]
    np.testing.assert_array_equal(positive_definite(A)[finite], definite)
    assert not positive_definite(A)[~finite].any()
    largest = np.abs(A[finite]).max(axis=(1, 2))
    np.testing.assert_array_equal(
        valid_or_not_stated(A, 10.0)[finite], (largest <= 10.0) & (spread[:, 0] >= -1e-9 * largest)
    )
    assert valid_or_not_stated(A, 10.0)[~finite].tolist() == [True, False, False, False]
    clear = clearly_definite(A, 1e-10)
    assert not (clear[finite] & ~definite).any()
    assert clear.mean() > 0.05  # nor is the bound of no use
    assert clearly_definite(np.eye(dim)[None], 1e-10).all()


def test_the_root_of_a_covariance_of_unlike_units_is_one() -> None:
    A = np.random.default_rng(1).standard_normal((4, 3)) * np.array([[1e-8], [1.0], [1e-3], [1e5]])
    root, sigma = covariance_root(A @ A.T), np.linalg.norm(A, axis=1)
    np.testing.assert_allclose(
        root @ root.T / np.outer(sigma, sigma), A @ A.T / np.outer(sigma, sigma), atol=1e-12
    )
    assert not covariance_root(np.zeros((2, 2))).any()


def test_inverses_are_the_same_to_the_last_digit_whether_equal_or_not() -> None:
    A = spread_matrices(2)[10:200]
    A = A @ A.swapaxes(1, 2) + np.eye(2)
    np.testing.assert_array_equal(inverses(A), np.linalg.inv(A))
    equal = np.tile(A[3], (5, 2, 1, 1))
    np.testing.assert_array_equal(inverses(equal), np.linalg.inv(equal))
    assert inverses(np.zeros((0, 2, 2))).shape == (0, 2, 2)
