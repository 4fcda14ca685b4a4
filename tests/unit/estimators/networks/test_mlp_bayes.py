from collections.abc import Callable

import numpy as np
import pytest
from scipy.stats import chi2

from labcal.errors import InputError
from labcal.estimators.networks.mlp import Mlp
from labcal.estimators.networks.mlp_bayes import MlpBayes

View = Callable[[np.ndarray], np.ndarray]
SIGMA_PX = 0.1


def noisy(X: np.ndarray) -> np.ndarray:
    return X + SIGMA_PX * np.random.default_rng(8).standard_normal(X.shape)


@pytest.fixture(scope="module")
def covariance() -> np.ndarray:
    return np.broadcast_to(SIGMA_PX**2 * np.eye(2), (1000, 2, 2, 2))


def rms(errors: np.ndarray) -> float:
    return float(np.sqrt((errors**2).sum(axis=1).mean()))


def test_it_does_not_learn_the_noise(
    stereo: View, volume: np.ndarray, other_volume: np.ndarray, covariance: np.ndarray
) -> None:
    few = volume[:100]
    X, seen = noisy(stereo(few)), noisy(stereo(other_volume))
    bayes = MlpBayes(hidden=(16, 16), max_epochs=200).fit(X, few)
    plain = Mlp(hidden=(16, 16), goal=0.0, max_epochs=200).fit(X, few)
    points, stated = bayes.predict_with_covariance(seen, covariance)
    assert rms(points - other_volume) < 0.5 * rms(plain.predict(seen) - other_volume)
    assert bayes.effective_parameters_ < 0.8 * bayes.parameters_.shape[1]
    errors = points - other_volume
    distance = np.einsum("ni,nij,nj->n", errors, np.linalg.inv(stated), errors)
    assert 0.9 < float((distance < chi2(3).ppf(0.95)).mean()) <= 1.0
    # Without the weights' uncertainty, pixels that are exactly known would give exact points.
    assert (np.linalg.eigvalsh(bayes.predict_with_covariance(seen, 0.0 * covariance)[1]) > 0).all()


def test_it_says_why_it_stopped(stereo: View, volume: np.ndarray) -> None:
    found = MlpBayes(hidden=(4,), max_epochs=400).fit(noisy(stereo(volume)), volume)
    assert found.stop_reason_ == "evidence settled"
    assert found.n_iter_ < 400
    assert len(found.history_) == found.n_iter_ + 1
    assert found.history_[-1] == found.mse_


@pytest.mark.parametrize("kind", [Mlp, MlpBayes])
def test_members_predict_their_mean_and_their_spread_counts(
    kind: type[Mlp] | type[MlpBayes], stereo: View, volume: np.ndarray, covariance: np.ndarray
) -> None:
    X = noisy(stereo(volume))
    together = kind(hidden=(6,), max_epochs=12, members=3, random_state=1).fit(X, volume)
    each = together._predictions(X)
    np.testing.assert_allclose(together.predict(X), each.mean(axis=0), rtol=1e-12)
    first = kind(hidden=(6,), max_epochs=12, random_state=1).fit(X, volume)
    np.testing.assert_allclose(first.predict(X), each[0], rtol=1e-6)
    _, stated = together.predict_with_covariance(X, covariance[: len(X)])
    apart = each - each.mean(axis=0)
    left = stated - np.einsum("mni,mnj->nij", apart, apart) / 3
    assert (np.linalg.eigvalsh(left) > 0).all()


def test_of_restarts_one_is_kept_with_all_that_belongs_to_it(stereo: View, volume: np.ndarray) -> None:
    X = noisy(stereo(volume))
    each = MlpBayes(hidden=(6,), max_epochs=12, members=3, random_state=1).fit(X, volume)
    raced = MlpBayes(hidden=(6,), max_epochs=12, restarts=3, random_state=1).fit(X, volume)
    (own,) = raced.parameters_
    kept = int(np.argmin(np.abs(each.parameters_ - own).max(axis=1)))
    assert kept != 0
    np.testing.assert_allclose(own, each.parameters_[kept], rtol=1e-4, atol=1e-6)
    np.testing.assert_allclose(raced.scales_, each.scales_[[kept]], rtol=1e-4)
    np.testing.assert_allclose(
        raced.weight_factors_[0],
        each.weight_factors_[kept],
        rtol=1e-3,
        atol=1e-4 * raced.weight_factors_.max(),
    )
    assert raced.mse_ < each.mse_  # which is the mean of all three


def test_further_outputs_are_learned(stereo: View, volume: np.ndarray) -> None:
    Y = np.column_stack((volume, np.linalg.norm(volume, axis=1)))
    X = stereo(volume)
    found = MlpBayes(hidden=(8,), max_epochs=60).fit(X, Y)
    points, stated = found.predict_with_covariance(X, np.zeros((len(X), 2, 2, 2)))
    assert (points.shape, stated.shape) == ((300, 4), (300, 3, 3))
    assert np.abs(points[:, 3] - Y[:, 3]).max() < 20


def test_same_seed_same_bytes(stereo: View, volume: np.ndarray) -> None:
    X = noisy(stereo(volume))
    one, two, other = (
        MlpBayes(hidden=(5,), max_epochs=10, random_state=seed).fit(X, volume).predict(X)
        for seed in (3, 3, 4)
    )
    assert one.tobytes() == two.tobytes()
    assert one.tobytes() != other.tobytes()


def test_bad_arguments_are_refused(stereo: View, volume: np.ndarray) -> None:
    with pytest.raises(InputError, match="members must be 1 or more"):
        MlpBayes(members=0).fit(stereo(volume), volume)
    with pytest.raises(InputError, match="restarts must be 1 or more"):
        MlpBayes(restarts=0).fit(stereo(volume), volume)
    with pytest.raises(InputError, match="must not be negative"):
        MlpBayes(max_epochs=-1).fit(stereo(volume), volume)
