"""Products of matrices through SciPy's BLAS."""

import numpy as np
from jaxtyping import Float64
from scipy.linalg.blas import dgemm, dsyrk


def inner_products(
    left: Float64[np.ndarray, "r n"], right: Float64[np.ndarray, "c n"], out: Float64[np.ndarray, "r c"]
) -> None:
    """Write the products of all rows of one matrix with all rows of another, ``left @ right.T``.

    All three have their rows in one piece, so that nothing is copied. On processors of AMD this takes 0.6 of
    the time that torch's MKL takes (decision "products of matrices", 2026-11-25).
    """
    dgemm(1.0, right.T, left.T, trans_a=1, c=out.T, overwrite_c=1)


def own_inner_products(rows: Float64[np.ndarray, "r n"], out: Float64[np.ndarray, "r r"]) -> None:
    """Write the lower triangle of the products of all rows of a matrix with each other."""
    # The lower triangle by rows is the upper one by columns.
    dsyrk(1.0, rows.T, trans=1, lower=0, c=out.T, overwrite_c=1)
