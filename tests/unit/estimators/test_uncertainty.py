"""What every method says of its own uncertainty."""

from collections.abc import Callable

import numpy as np
import pytest
from scipy.stats import chi2

from labcal.errors import InputError
from labcal.estimators.affine import Affine
from labcal.estimators.dlt import Dlt
from labcal.estimators.linear_camera_estimator import LinearCameraEstimator
from labcal.estimators.propagation import propagated_covariance
from labcal.estimators.two_plane import TwoPlane
from labcal.evaluate.statistics import coverage

View = Callable[[np.ndarray], np.ndarray]


def per_camera(points: int, seed: int) -> np.ndarray:
    """Return random covariances of two cameras, px squared."""
    root = 0.1 * np.random.default_rng(seed).standard_normal((points, 2, 2, 2))
    return root @ root.mT


def test_noise_pushed_through_a_linear_map_is_exact() -> None:
    A = np.random.default_rng(1).standard_normal((3, 4))
    covariance = per_camera(5, 2)
    found = propagated_covariance(
        lambda pixels: pixels @ A.T, np.random.default_rng(3).uniform(0, 640, (5, 4)), covariance
    )
    for one, of_cameras in zip(found, covariance, strict=True):
        whole = np.zeros((4, 4))
        whole[:2, :2], whole[2:, 2:] = of_cameras
        np.testing.assert_allclose(one, A @ whole @ A.T, rtol=1e-7, atol=1e-12)


def test_triangulated_noise_has_the_stated_covariance(stereo: View, volume: np.ndarray) -> None:
    estimator, sigma = Dlt().fit(stereo(volume), volume), 0.2
    rng = np.random.default_rng(4)
    noisy = stereo(volume) + sigma * rng.standard_normal((len(volume), 4))
    covariance = np.broadcast_to(sigma**2 * np.eye(2), (len(volume), 2, 2, 2))
    points, stated = estimator.predict_with_covariance(noisy, covariance)
    np.testing.assert_array_equal(points, estimator.predict(noisy))
    errors = points - volume
    statistic = np.einsum("ni,nij,nj->", errors, np.linalg.inv(stated), errors)
    assert 0.001 < chi2(3 * len(volume)).cdf(statistic) < 0.999


def test_what_was_not_learned_enters(stereo: View, volume: np.ndarray) -> None:
    """Of a linear regression, errors on points held out are somewhat larger than those in training."""
    X = stereo(volume)
    estimator = Affine().fit(X, volume)
    _, stated = estimator.predict_with_covariance(X, np.zeros((len(X), 2, 2, 2)))
    errors = estimator.predict(X) - volume
    trained = errors.T @ errors / len(X)
    assert np.ptp(stated, axis=0).max() == 0.0
    assert 1.0 < np.trace(stated[0]) / np.trace(trained) < 1.3


@pytest.mark.parametrize("method", [Dlt, TwoPlane])
@pytest.mark.parametrize("sigma", [0.05, 0.5])
def test_noise_does_not_count_twice(
    method: type[LinearCameraEstimator], sigma: float, stereo: View, volume: np.ndarray
) -> None:
    """A method that is right errs by the noise, which was in the training pixels as well."""
    rng = np.random.default_rng(8)
    trained = stereo(volume)
    estimator = method().fit(trained + sigma * rng.standard_normal(trained.shape), volume)
    p = rng.uniform(volume.min(axis=0), volume.max(axis=0), (4000, 3))
    noisy = stereo(p) + sigma * rng.standard_normal((len(p), 4))
    covariance = np.broadcast_to(sigma**2 * np.eye(2), (len(p), 2, 2, 2))
    points, stated = estimator.predict_with_covariance(noisy, covariance)
    assert 0.93 < coverage(points - p, stated) < 0.97


def test_noise_of_other_pixels_than_the_trained_ones_is_propagated(stereo: View, volume: np.ndarray) -> None:
    rng = np.random.default_rng(9)
    trained = stereo(volume)
    estimator = Dlt().fit(trained + 0.05 * rng.standard_normal(trained.shape), volume)
    noisy = trained + 0.5 * rng.standard_normal(trained.shape)
    covariance = np.tile(0.25 * np.eye(2), (len(noisy), 2, 1, 1))
    points, stated = estimator.predict_with_covariance(noisy, covariance)
    assert abs(coverage(points - volume, stated) - 0.95) < 4.0 * np.sqrt(0.95 * 0.05 / len(noisy))


def test_pixels_without_covariance_give_points_without(stereo: View, volume: np.ndarray) -> None:
    covariance = per_camera(len(volume), 5)
    covariance[7, 1] = np.nan
    _, stated = Affine().fit(stereo(volume), volume).predict_with_covariance(stereo(volume), covariance)
    np.testing.assert_array_equal(np.isnan(stated).all(axis=(1, 2)), np.arange(len(volume)) == 7)


def test_further_outputs_have_no_covariance(stereo: View, volume: np.ndarray) -> None:
    X = stereo(volume)
    estimator = Affine().fit(X, np.column_stack((volume, X[:, :2])))
    points, stated = estimator.predict_with_covariance(X, per_camera(len(X), 6))
    assert (points.shape, stated.shape) == ((len(X), 5), (len(X), 3, 3))


def test_covariances_of_another_shape_are_refused(stereo: View, volume: np.ndarray) -> None:
    estimator = Affine().fit(stereo(volume), volume)
    with pytest.raises(InputError, match="one of 2 x 2 for each point and camera"):
        estimator.predict_with_covariance(stereo(volume), per_camera(len(volume) - 1, 7))


@pytest.mark.parametrize("method", [Dlt, TwoPlane])
def test_few_points_leave_a_method_as_uncertain_as_it_says(
    method: type[LinearCameraEstimator], stereo: View, volume: np.ndarray
) -> None:
    """On average over fits, and at each place: an error that all points of a fit share is no noise."""
    rng, sigma, covered, ratios = np.random.default_rng(10), 0.5, [], []
    for _ in range(40):
        trained = rng.uniform(volume.min(axis=0), volume.max(axis=0), (40, 3))
        X = stereo(trained) + sigma * rng.standard_normal((len(trained), 4))
        fitted = method(**({"degree": 2} if method is TwoPlane else {})).fit(X, trained)
        p = rng.uniform(volume.min(axis=0), volume.max(axis=0), (100, 3))
        noisy = stereo(p) + sigma * rng.standard_normal((len(p), 4))
        points, stated = fitted.predict_with_covariance(
            noisy, np.tile(sigma**2 * np.eye(2), (len(p), 2, 1, 1))
        )
        error = points - p
        covered.append(coverage(error, stated))
        ratios.append((error**2).sum(axis=1) / np.trace(stated, axis1=1, axis2=2))
    assert abs(np.mean(covered) - 0.95) < 4.0 * np.std(covered) / np.sqrt(len(covered))
    assert abs(np.mean(ratios) - 1.0) < 0.15


def test_ellipsoids_grow_where_nothing_was_trained(stereo: View, volume: np.ndarray) -> None:
    rng = np.random.default_rng(11)
    X = stereo(volume) + 0.5 * rng.standard_normal((len(volume), 4))
    fitted = TwoPlane(degree=3).fit(X, volume)
    middle, beyond = volume.mean(axis=0), volume.max(axis=0) + np.array([300.0, 300.0, 0.0])
    exact = np.zeros((2, 2, 2, 2))
    _, stated = fitted.predict_with_covariance(stereo(np.stack([middle, beyond])), exact + 0.25 * np.eye(2))
    own = np.trace(stated, axis1=1, axis2=2)
    assert own[1] > 3.0 * own[0]
