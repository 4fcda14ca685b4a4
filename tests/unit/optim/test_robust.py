"""Losses: values at known places, and the weight as the slope of the cost."""

import numpy as np
import pytest

from labcal.errors import InputError
from labcal.optim.robust import SQUARES, Huber, Loss


def test_known_values() -> None:
    square = np.array([0.0, 4.0, 9.0, 100.0])
    np.testing.assert_allclose(SQUARES.cost(square), square)
    np.testing.assert_allclose(Huber(3.0).cost(square), [0.0, 4.0, 9.0, 2 * 3 * 10 - 9])
    np.testing.assert_allclose(Huber(3.0).weight(square), [1.0, 1.0, 1.0, 0.3])


@pytest.mark.parametrize("loss", [SQUARES, Huber(1.5)])
def test_the_weight_is_the_slope(loss: Loss) -> None:
    square = np.linspace(0.1, 20.0, 50)
    slope = (loss.cost(square + 1e-6) - loss.cost(square - 1e-6)) / 2e-6
    np.testing.assert_allclose(loss.weight(square), slope, rtol=1e-6)


def test_a_bound_must_bound() -> None:
    with pytest.raises(InputError, match="above 0"):
        Huber(0.0)
