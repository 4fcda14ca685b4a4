from collections.abc import Callable

import numpy as np
import pytest

from labcal.errors import InputError
from labcal.estimators.affine import Affine
from labcal.estimators.quadratic import Quadratic

View = Callable[[np.ndarray], np.ndarray]


def rms(errors: np.ndarray) -> float:
    return float(np.sqrt(np.mean(np.sum(errors**2, axis=1))))


def test_exact_where_points_are_quadratic_in_pixels(stereo: View, volume: np.ndarray) -> None:
    X = stereo(volume)
    Y = np.column_stack((X[:, 0] * X[:, 3], X[:, 1] ** 2 - 3 * X[:, 2], 5 + X[:, 0] * X[:, 1] - X[:, 2] ** 2))
    np.testing.assert_allclose(Quadratic().fit(X[:200], Y[:200]).predict(X[200:]), Y[200:], rtol=1e-9)


def test_better_than_affine_on_perspective(
    stereo: View, volume: np.ndarray, other_volume: np.ndarray
) -> None:
    errors = [
        rms(method.fit(stereo(volume), volume).predict(stereo(other_volume)) - other_volume)
        for method in (Affine(), Quadratic())
    ]
    assert errors[1] < errors[0] / 3


def test_nearly_dependent_terms_on_a_plane_do_no_harm(
    stereo: View, plane: np.ndarray, other_plane: np.ndarray
) -> None:
    noise = np.random.default_rng(4).standard_normal((300, 4))
    fitted = Quadratic().fit(stereo(plane) + 0.1 * noise, plane)
    # 0.1 px are about 0.2 mm here.
    assert rms(fitted.predict(stereo(other_plane)) - other_plane) < 0.2
    assert np.ptp(fitted.predict(stereo(other_plane))[:, 2]) < 1e-9


def test_too_few_points_are_refused(stereo: View, volume: np.ndarray) -> None:
    with pytest.raises(InputError, match="14 points were given, but at least 15"):
        Quadratic().fit(stereo(volume[:14]), volume[:14])
