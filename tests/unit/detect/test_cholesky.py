"""Small systems in compiled code are solved as LAPACK solves them."""

import numpy as np

from labcal.detect.cholesky import factorise, solve


def test_systems_are_solved_as_by_lapack() -> None:
    random = np.random.default_rng(0)
    square = random.normal(size=(14, 14))
    matrix, right = square @ square.T + np.eye(14), random.normal(size=14)
    factor, solved = matrix.copy(), right.copy()
    assert factorise(factor, 14, 1e-12)
    solve(factor, solved)
    np.testing.assert_allclose(solved, np.linalg.solve(matrix, right), rtol=1e-9)
    assert not factorise(np.zeros((14, 14)), 14, 1e-12)
