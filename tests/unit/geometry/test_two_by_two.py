import numpy as np

from labcal.geometry.two_by_two import determinants, eigenvalues, inverses, matrix_roots

M = np.random.default_rng(0).normal(size=(3, 50, 2, 2))
POSITIVE = M @ np.swapaxes(M, -1, -2) + 0.01 * np.eye(2)


def test_closed_forms_are_lapacks() -> None:
    np.testing.assert_allclose(determinants(M), np.linalg.det(M), rtol=1e-10)
    np.testing.assert_allclose(inverses(M), np.linalg.inv(M), rtol=1e-8)
    np.testing.assert_allclose(eigenvalues(POSITIVE), np.linalg.eigvalsh(POSITIVE), rtol=1e-9, atol=1e-12)
    root = matrix_roots(POSITIVE)
    np.testing.assert_allclose(root @ root, POSITIVE, rtol=1e-9, atol=1e-12)
    assert (np.linalg.eigvalsh(root) > 0.0).all()


def test_eigenvalues_of_a_product_of_positive_matrices() -> None:
    product = POSITIVE @ np.roll(POSITIVE, 1, axis=1)
    found = np.sort(np.linalg.eigvals(product).real, axis=-1)
    np.testing.assert_allclose(eigenvalues(product), found, rtol=1e-7, atol=1e-10)


def test_a_single_matrix_and_none() -> None:
    assert float(determinants(np.eye(2))) == 1.0
    assert inverses(np.empty((0, 2, 2))).shape == (0, 2, 2)
    np.testing.assert_array_equal(eigenvalues(np.diag([3.0, 1.0])), [1.0, 3.0])
