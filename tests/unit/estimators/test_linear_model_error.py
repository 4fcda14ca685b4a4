"""Error of a model that is linear in its parameters, on models whose truth has terms that they lack."""

import numpy as np
import pytest

from labcal.estimators.linear_model_error import LinearModelError, Slopes

SIGMA_PX, LACKING = 0.3, 0.8
POINTS, REPEATED = 40, 400


def slopes(x: np.ndarray) -> Slopes:
    """Return those of straight lines in both pixel coordinates, which lack squares and cubes."""
    both = np.eye(2)[None, :, :, None]
    fitted = np.stack([np.ones_like(x), x], axis=1)[:, None, None, :] * both
    left_out = np.stack([x**2, x**3], axis=1)[:, None, None, :] * both
    return Slopes(fitted.reshape(len(x), 2, 4), left_out.reshape(len(x), 2, 4))


def fitted(
    x: np.ndarray, sigma: float, lacking: np.ndarray, seed: int
) -> tuple[np.ndarray, LinearModelError]:
    """Return the parameters of a fit to pixels that hold the lacking terms, and their error; truth is 0."""
    noise = sigma * np.random.default_rng(seed).standard_normal((len(x), 2))
    at = slopes(x)
    q = at.by_lacking @ lacking + noise
    inverse = np.linalg.pinv(at.by_parameter.reshape(-1, 4))
    parameters = inverse @ q.ravel()
    response = inverse.reshape(4, len(x), 2).transpose(1, 0, 2)
    return parameters, LinearModelError.of(at.by_parameter @ parameters - q, response, at)


def test_both_variances_are_found() -> None:
    """Their estimates are means of squares, so that many of them average to the truth."""
    x = np.linspace(-1.0, 1.0, POINTS)
    random = np.random.default_rng(1)
    found = np.array(
        [
            (error.noise_px2, error.lacking_variance)
            for seed in range(REPEATED)
            for _, error in [fitted(x, SIGMA_PX, LACKING * random.standard_normal(4), seed)]
        ]
    )
    z = (found.mean(axis=0) - (SIGMA_PX**2, LACKING**2)) / (found.std(axis=0) / np.sqrt(REPEATED))
    assert (np.abs(z) < 4.0).all()


def test_stated_covariance_is_that_of_errors_at_each_place() -> None:
    """In the middle, at the end, and beyond, where the lacking terms grow."""
    x, places = np.linspace(-1.0, 1.0, POINTS), np.array([0.0, 0.6, 1.0, 1.4])
    random, at = np.random.default_rng(2), slopes(places)
    exact = np.tile(SIGMA_PX**2 * np.eye(2), (len(places), 1, 1))
    squares, stated = [], []
    for seed in range(REPEATED):
        lacking = LACKING * random.standard_normal(4)
        parameters, error = fitted(x, SIGMA_PX, lacking, seed)
        off = at.by_parameter @ parameters - at.by_lacking @ lacking
        squares.append((off**2).sum(axis=1))
        stated.append(np.trace(error.covariance(at, exact), axis1=1, axis2=2))
    ratio = np.mean(squares, axis=0) / np.mean(stated, axis=0)
    spread = np.hypot(*(np.std(v, axis=0) / np.mean(v, axis=0) for v in (squares, stated))) / np.sqrt(
        REPEATED
    )
    assert (np.abs(ratio - 1.0) / spread < 4.0).all()
    assert np.mean(stated, axis=0)[3] > 10.0 * np.mean(stated, axis=0)[0]


def test_terms_that_the_fit_takes_up_are_not_lacking() -> None:
    x = np.linspace(-1.0, 1.0, POINTS)
    at = slopes(x)
    same = Slopes(at.by_parameter, at.by_parameter)
    noise = SIGMA_PX * np.random.default_rng(3).standard_normal((POINTS, 2))
    inverse = np.linalg.pinv(at.by_parameter.reshape(-1, 4))
    response = inverse.reshape(4, POINTS, 2).transpose(1, 0, 2)
    residual = at.by_parameter @ (inverse @ noise.ravel()) - noise
    error = LinearModelError.of(residual, response, same)
    assert error.lacking_variance * np.abs(at.by_parameter - at.by_parameter @ error.alias).max() < 1e-9
    assert error.noise_px2 == pytest.approx((residual**2).sum() / (2 * POINTS - 4))


def test_where_points_are_too_few_to_tell_all_is_noise() -> None:
    x = np.linspace(-1.0, 1.0, 4)
    _, error = fitted(x, SIGMA_PX, np.full(4, LACKING), 4)
    assert error.lacking_variance == 0.0
    assert error.noise_px2 > 0.0
