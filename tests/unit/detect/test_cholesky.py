"""Small systems in compiled code are solved as LAPACK solves them."""

import numpy as np

from labcal.detect.cholesky import factorise, solve, solve_columns


def test_columns_are_solved_with_the_bytes_of_single_ones() -> None:
    random = np.random.default_rng(0)
    square = random.normal(size=(14, 14))
    matrix, right = square @ square.T + np.eye(14), random.normal(size=(14, 16))
    factor, together = matrix.copy(), right.copy()
    assert factorise(factor, 14, 1e-12)
    solve_columns(factor, together)
    np.testing.assert_allclose(together, np.linalg.solve(matrix, right), rtol=1e-9)
    for side in range(16):
        alone = right[:, side].copy()
        solve(factor, alone)
        assert alone.tobytes() == together[:, side].tobytes()
