"""Rays through two planes."""

from collections.abc import Callable

import numpy as np
import pytest

from labcal.errors import InputError
from labcal.estimators.two_plane import TwoPlane

View = Callable[[np.ndarray], np.ndarray]


def test_near_to_exact_for_pinhole_cameras_and_any_number_of_them(
    stereo: View, three_cameras: View, volume: np.ndarray, other_volume: np.ndarray
) -> None:
    for view in (stereo, three_cameras):
        fitted = TwoPlane(degree=5).fit(view(volume), volume)
        error = fitted.predict(view(other_volume)) - other_volume
        assert np.sqrt((error**2).sum(axis=1).mean()) < 0.05


def test_held_out_edges_choose_a_low_degree_where_noise_hides_more(stereo: View, volume: np.ndarray) -> None:
    exact = stereo(volume)
    noisy = exact + 2.0 * np.random.default_rng(1).standard_normal(exact.shape)
    assert max(TwoPlane().fit(noisy, volume).degrees_) < min(TwoPlane().fit(exact, volume).degrees_)


def test_a_turned_world_changes_nothing(stereo: View, volume: np.ndarray) -> None:
    turn = np.linalg.qr(np.random.default_rng(2).standard_normal((3, 3)))[0]
    X = stereo(volume)
    plain = TwoPlane(degree=3).fit(X, volume).predict(X)
    turned = TwoPlane(degree=3).fit(X, volume @ turn.T).predict(X)
    assert np.abs(turned @ turn - plain).max() < 0.5


def test_what_cannot_be_fitted_is_refused(stereo: View, volume: np.ndarray, plane: np.ndarray) -> None:
    X = stereo(volume)
    for estimator, pixels, points, said in (
        (TwoPlane(), X[:, :2], volume, "one camera"),
        (TwoPlane(), stereo(plane), plane, "one plane"),
        (TwoPlane(degree=5), X[:41], volume[:41], "at least 42"),
        (TwoPlane(degree=12), X, volume, "0 to 9"),
        (TwoPlane(), X, volume[:, :2], "2 columns"),
    ):
        with pytest.raises(InputError, match=said):
            estimator.fit(pixels, points)
