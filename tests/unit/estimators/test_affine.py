import subprocess
import sys
from collections.abc import Callable

import numpy as np
import pytest
from sklearn.base import clone

from labcal.errors import InputError, InputTypeError
from labcal.estimators.affine import Affine

View = Callable[[np.ndarray], np.ndarray]


def affine_cameras(points: np.ndarray) -> np.ndarray:
    matrix = np.random.default_rng(1).uniform(-1, 1, (3, 4))
    return points @ matrix + np.array([320.0, 240.0, 300.0, 200.0])


def test_exact_for_affine_cameras(volume: np.ndarray, other_volume: np.ndarray) -> None:
    found = Affine().fit(affine_cameras(volume), volume).predict(affine_cameras(other_volume))
    np.testing.assert_allclose(found, other_volume, atol=1e-8)


def test_plane_seen_by_affine_cameras_has_dependent_columns_and_is_exact(
    plane: np.ndarray, other_plane: np.ndarray
) -> None:
    found = Affine().fit(affine_cameras(plane), plane).predict(affine_cameras(other_plane))
    np.testing.assert_allclose(found, other_plane, atol=1e-8)


def test_is_the_least_squares_solution(stereo: View, volume: np.ndarray, other_volume: np.ndarray) -> None:
    def terms(points: np.ndarray) -> np.ndarray:
        return np.column_stack((np.ones(len(points)), stereo(points)))

    expected = terms(other_volume) @ np.linalg.solve(
        terms(volume).T @ terms(volume), terms(volume).T @ volume
    )
    found = Affine().fit(stereo(volume), volume).predict(stereo(other_volume))
    np.testing.assert_allclose(found, expected, atol=1e-6)
    assert np.abs(found - other_volume).max() > 10  # perspective is not affine


def test_further_outputs_and_a_single_one(stereo: View, volume: np.ndarray) -> None:
    X = stereo(volume)
    more = Affine().fit(X, np.column_stack((volume, X[:, 0]))).predict(X)
    np.testing.assert_allclose(more[:, 3], X[:, 0], atol=1e-9)
    np.testing.assert_allclose(Affine().fit(X, X[:, 1]).predict(X), X[:, 1], atol=1e-9)


def test_clone_is_unfitted_and_equal(stereo: View, volume: np.ndarray) -> None:
    fitted = Affine().fit(stereo(volume), volume)
    assert not hasattr(clone(fitted), "coefficients_")
    assert clone(fitted).get_params() == fitted.get_params()


def test_missing_values_are_refused_by_name(stereo: View, volume: np.ndarray) -> None:
    X = stereo(volume)
    X[3, 1] = np.nan
    with pytest.raises(InputError, match=r"X contains NaN.*Leave out the dots"):
        Affine().fit(X, volume)
    with pytest.raises(InputError, match=r"X contains NaN.*Leave out the dots"):
        Affine().fit(stereo(volume), volume).predict(X)


def test_wrong_width_lengths_and_type_are_refused(stereo: View, volume: np.ndarray) -> None:
    X = stereo(volume)
    with pytest.raises(InputError, match=r"3 features.*expecting 4"):
        Affine().fit(X, volume).predict(X[:, :3])
    with pytest.raises(InputError, match="inconsistent numbers of samples"):
        Affine().fit(X[:-1], volume)
    with pytest.raises(InputError, match="Expected 2D array"):
        Affine().fit(X[0], volume)
    with pytest.raises(InputTypeError):
        Affine().fit([{"x": 1.0}] * 300, volume)


def test_too_few_points_are_refused(stereo: View, volume: np.ndarray) -> None:
    with pytest.raises(InputError, match="4 points were given, but at least 5"):
        Affine().fit(stereo(volume[:4]), volume[:4])


def test_collinear_dots_are_refused(stereo: View) -> None:
    line = np.linspace((700, 700, 100), (1300, 1000, 500), 30)
    with pytest.raises(InputError, match="on one line"):
        Affine().fit(stereo(line), line)


def test_needs_neither_torch_nor_opencv() -> None:
    heavy = ("torch", "cv2", "mitsuba")
    code = f"import sys, labcal.estimators.affine; print([m for m in {heavy} if m in sys.modules])"
    found = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=True)
    assert found.stdout.strip() == "[]"
