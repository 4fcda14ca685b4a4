"""Scalar products of rows by vector instructions."""

import numpy as np
import pytest

from labcal.detect.row_products import add_own_products, add_products, copy_columns, filled_up
from labcal.rng import generator


@pytest.mark.parametrize("part", [(0, 64), (8, 16), (4, 60), (20, 20)])
def test_products_of_all_pairs_of_rows_are_added(part: tuple[int, int]) -> None:
    random = generator(0, "test", "products")
    left, right = random.normal(size=(6, 64)), random.normal(size=(8, 64))
    sums = np.ones((6, 8))
    add_products(left, right, part, sums)
    some = slice(*part)
    np.testing.assert_allclose(sums - 1.0, left[:, some] @ right[:, some].T, rtol=0, atol=1e-13)


def test_products_with_rows_of_a_larger_array_and_themselves() -> None:
    rows = generator(1, "test", "products").normal(size=(20, 192))[3:19]
    assert not rows.flags.owndata
    sums = np.zeros((16, 16))
    add_own_products(rows, 104, sums)
    expected = rows[:, :104] @ rows[:, :104].T
    lower = np.tril_indices(16)
    np.testing.assert_allclose(sums[lower], expected[lower], rtol=0, atol=1e-13)


def test_the_order_of_the_sum_is_as_documented() -> None:
    """The bytes do not depend on what the compiler makes of the loop."""
    random = generator(2, "test", "products")
    left, right = random.normal(size=(2, 40)), random.normal(size=(4, 40))
    sums = np.zeros((2, 4))
    add_products(left, right, (0, 40), sums)
    for i in range(2):
        for j in range(4):
            lanes = [0.0] * 8
            for k in range(40):
                lanes[k % 8] += float(left[i, k] * right[j, k])
            while len(lanes) > 1:
                half = len(lanes) // 2
                lanes = [one + other for one, other in zip(lanes[:half], lanes[half:], strict=True)]
            assert sums[i, j] == lanes[0]


def test_columns_are_copied_and_rows_are_filled_up() -> None:
    source, target = np.arange(30.0).reshape(3, 10), np.zeros((4, 8))
    copy_columns(source, 2, target, (1, 5))
    np.testing.assert_array_equal(target[:3, 1:6], source[:, 2:7])
    assert target[3].sum() == 0.0
    assert target[:, 0].sum() == 0.0
    assert [filled_up(count) for count in (0, 1, 8, 9)] == [0, 8, 8, 16]
