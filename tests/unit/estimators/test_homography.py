from collections.abc import Callable

import numpy as np
import pytest

from labcal.errors import InputError
from labcal.estimators.homography import Homography

View = Callable[[np.ndarray], np.ndarray]


def test_exact_on_a_plane_for_any_number_of_cameras(
    stereo: View, three_cameras: View, plane: np.ndarray, other_plane: np.ndarray
) -> None:
    for view in (stereo, three_cameras, lambda points: stereo(points)[:, :2]):
        found = Homography().fit(view(plane), plane).predict(view(other_plane))
        np.testing.assert_allclose(found, other_plane, atol=1e-7)


def test_z_is_exactly_the_trained_one(stereo: View, plane: np.ndarray) -> None:
    found = Homography().fit(stereo(plane), plane).predict(stereo(plane) + 1.0)
    assert np.all(found[:, 2] == 200.0)


def test_four_points_suffice_and_cameras_are_averaged(stereo: View, plane: np.ndarray) -> None:
    corners = plane[[0, 19, 280, 299]]
    fitted = Homography().fit(stereo(corners), corners)
    X = stereo(plane)
    np.testing.assert_allclose(fitted.predict(X), plane, atol=1e-7)
    moved = X.copy()
    moved[:, 0] += 2.0
    one_camera = Homography().fit(stereo(corners)[:, :2], corners)
    shift = one_camera.predict(moved[:, :2]) - one_camera.predict(X[:, :2])
    np.testing.assert_allclose(fitted.predict(moved) - fitted.predict(X), shift / 2, atol=1e-7)


def test_noise_is_near_what_two_cameras_allow(stereo: View, plane: np.ndarray) -> None:
    X = stereo(plane)
    noisy = X + 0.1 * np.random.default_rng(2).standard_normal(X.shape)
    errors = Homography().fit(noisy, plane).predict(X) - plane
    # 300 dots leave a few hundredths of the noise of one dot, 0.1 px or 0.2 mm.
    assert 1e-4 < np.sqrt(np.mean(errors[:, :2] ** 2)) < 0.03


def test_more_than_one_plane_is_refused(stereo: View, volume: np.ndarray) -> None:
    with pytest.raises(InputError, match=r"more than one plane.*'dlt'"):
        Homography().fit(stereo(volume), volume)


def test_degenerate_input_is_refused(stereo: View, plane: np.ndarray) -> None:
    with pytest.raises(InputError, match="on one line"):
        Homography().fit(stereo(plane[:20]), plane[:20])
    with pytest.raises(InputError, match="3 points were given, but at least 4"):
        Homography().fit(stereo(plane[[0, 19, 280]]), plane[[0, 19, 280]])
    with pytest.raises(InputError, match="two a camera"):
        Homography().fit(stereo(plane)[:, :3], plane)
    with pytest.raises(InputError, match="needs three: X Y Z"):
        Homography().fit(stereo(plane), plane[:, :2])
    flat = stereo(plane)
    flat[:, 3] = flat[:, 2]
    with pytest.raises(InputError, match="camera 2: all 300 dots lie on one line"):
        Homography().fit(flat, plane)
    # Three dots of four on one line leave the homography open.
    triple = plane[[0, 5, 19, 299]]
    with pytest.raises(InputError, match="undetermined"):
        Homography().fit(stereo(triple), triple)
