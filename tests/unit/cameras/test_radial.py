"""The first guess of the inverse of a radial mapping."""

import numpy as np
import pytest

from labcal.cameras.radial import DEGREE, _powers, inverse_guess


@pytest.mark.parametrize("seed", range(5))
def test_series_are_converted_to_the_bytes_that_numpy_gives(seed: int) -> None:
    coefficients = np.random.default_rng(seed).standard_normal(DEGREE + 1) * 0.3 ** np.arange(DEGREE + 1)
    series = np.polynomial.Chebyshev(coefficients, domain=[0.0, 1.0])
    expected = series.convert(kind=np.polynomial.Polynomial).coef
    assert np.array(_powers(coefficients)).tobytes() == expected.tobytes()


def test_guess_is_near_the_inverse_up_to_its_reach() -> None:
    image = np.linspace(0.01, 0.6, 50)
    scale, *powers = inverse_guess(lambda r: np.asarray(r * (1.0 - 0.2 * r * r)), np.sqrt(1.0 / 0.6), 0.6)
    field = image * np.polynomial.polynomial.polyval(scale * image**2, powers)
    np.testing.assert_allclose(field * (1.0 - 0.2 * field**2), image, rtol=1e-6)
