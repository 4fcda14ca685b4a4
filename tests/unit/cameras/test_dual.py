import numpy as np
import pytest

from labcal.cameras.dual import Dual, DualMathematics, constant, variables
from labcal.cameras.mathematics import NUMPY

M = DualMathematics(NUMPY)
A, B = np.random.default_rng(1).uniform(0.3, 2.0, (2, 50))

FORMULAS = {
    "sum": (lambda a, b: a + 2.0 * b + 1.0, lambda a, b: (1 + 0 * a, 2 + 0 * b)),
    "difference": (lambda a, b: 3.0 - a - b, lambda a, b: (-1 + 0 * a, -1 + 0 * b)),
    "product": (lambda a, b: a * b * a, lambda a, b: (2 * a * b, a * a)),
    "quotient": (lambda a, b: a / b, lambda a, b: (1 / b, -a / b**2)),
    "reciprocal": (lambda a, b: 2.0 / (a * b), lambda a, b: (-2 / (a**2 * b), -2 / (a * b**2))),
    "array on the left": (lambda a, b: A * (a - b), lambda a, b: (A + 0 * a, -A + 0 * b)),
    "root": (lambda a, b: M.sqrt(a * b), lambda a, b: (np.sqrt(b / a) / 2, np.sqrt(a / b) / 2)),
    "sine": (lambda a, b: M.sin(a * b), lambda a, b: (b * np.cos(a * b), a * np.cos(a * b))),
    "cosine": (lambda a, b: M.cos(a) * b, lambda a, b: (-b * np.sin(a), np.cos(a))),
    "angle": (M.atan2, lambda a, b: (b / (a**2 + b**2), -a / (a**2 + b**2))),
    "choice": (
        lambda a, b: M.where(a < b, a * b, 1.0),
        lambda a, b: (np.where(a < b, b, 0), np.where(a < b, a, 0)),
    ),
}


@pytest.mark.parametrize("name", FORMULAS)
def test_slopes_are_the_derivatives(name: str) -> None:
    formula, expected = FORMULAS[name]
    found = formula(*variables(A, B))
    for slope, wanted in zip(found.slopes, expected(A, B), strict=True):
        np.testing.assert_allclose(np.broadcast_to(slope, A.shape), wanted, rtol=1e-13, atol=1e-15)


def test_what_does_not_vary_costs_nothing() -> None:
    product = constant(A, 2) * constant(B, 2) + 1.0
    assert isinstance(product, Dual)
    assert product.slopes == (0.0, 0.0)
