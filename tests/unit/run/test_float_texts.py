import numpy as np
import pytest

from labcal.run.float_texts import float_texts

SPECIAL = [0.0, -0.0, 1e-4, 9.9e-5, -1e-5, 5e-324, 9999999999999998.0, 1e16, -1e22, 1e23, 2.0**53, 1e300]


@pytest.mark.parametrize("seed", [1, 2])
def test_texts_are_those_of_repr(seed: int) -> None:
    """Of numbers as measurements have them, of any bits, and of some that have an exponent."""
    random = np.random.default_rng(seed)
    usual = random.standard_normal(20_000) * 10.0 ** random.integers(-3, 6, 20_000)
    bits = random.integers(0, 2**63, 20_000).view(np.float64)
    few = np.concatenate([usual, bits[:500], SPECIAL, [np.nan, np.inf, -np.inf]])
    for values in (usual, bits, few, np.round(usual, 2)):
        assert float_texts(values) == list(map(repr, values.tolist()))


def test_no_numbers_have_no_texts() -> None:
    assert float_texts(np.empty(0)) == []
