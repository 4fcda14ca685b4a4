"""The field's numerics against scikit-learn's Gaussian process, and against differences."""

import numpy as np
import pytest
from sklearn.gaussian_process import GaussianProcessRegressor
from sklearn.gaussian_process.kernels import RBF, ConstantKernel

from labcal.estimators.gp_field.evidence import FieldScale, _Restricted, field_scale
from labcal.estimators.gp_field.kernel import FieldKernel
from labcal.estimators.gp_field.pixel_field import PixelField

RANDOM = np.random.default_rng(4)
X = RANDOM.uniform(0.0, 1.0, (150, 3))
ASKED = RANDOM.uniform(0.0, 1.0, (30, 3))
KERNEL = FieldKernel(across=0.3, along=1.2)
WAVES = FieldKernel(across=0.9, along=1.2, wavenumber=25.0)
EITHER = pytest.mark.parametrize("kernel", [KERNEL, WAVES], ids=["smooth", "waves"])
NOTHING_FREE = np.zeros((150, 2, 0))


def wavy(x: np.ndarray) -> np.ndarray:
    return np.stack([np.sin(5.0 * x[:, 0] + x[:, 2]), np.cos(4.0 * x[:, 1])], axis=1)


def test_the_field_is_the_gaussian_process_of_scikit_learn() -> None:
    field = PixelField(FieldScale(KERNEL, 1.3, 0.1, 0.0), X, wavy(X))
    other = GaussianProcessRegressor(
        ConstantKernel(1.3**2) * RBF(KERNEL.lengths), alpha=0.1**2, optimizer=None
    ).fit(X, wavy(X))
    mean, deviation = other.predict(ASKED, return_std=True)
    np.testing.assert_allclose(field.at(ASKED), mean, atol=1e-9)
    variance = 1.3**2 - (field.reach(ASKED) ** 2).sum(axis=0)
    np.testing.assert_allclose(variance, deviation[:, 0] ** 2, atol=1e-9)


def test_waves_are_those_of_one_period_in_all_directions() -> None:
    """The mean over directions of the correlation of a plane wave with itself, summed numerically."""
    angle = np.linspace(0.0, 2.0 * np.pi, 400, endpoint=False)
    apart = ASKED[:, None, :2] - X[None, :, :2]
    phase = 25.0 * (apart[..., 0, None] * np.cos(angle) + apart[..., 1, None] * np.sin(angle))
    decay = FieldKernel(0.9, 1.2).between(ASKED, X)
    np.testing.assert_allclose(WAVES.between(ASKED, X), decay * np.cos(phase).mean(axis=2), atol=1e-9)
    assert np.linalg.eigvalsh(WAVES.between(X, X))[0] > -1e-9


def test_the_period_of_waves_is_found_and_a_smooth_field_has_none() -> None:
    """Three waves of one period and any direction, as glass has them."""
    noise = 0.02 * RANDOM.standard_normal((150, 2))
    directions = 25.0 * np.array([[1.0, 0.0], [-0.6, 0.8], [0.28, 0.96]])
    phases = X[:, :2] @ directions.T
    residual = np.stack([np.sin(phases).sum(axis=1), np.cos(phases + 1.0).sum(axis=1)], axis=1) + noise
    found, likelihood = field_scale(X, residual, NOTHING_FREE)
    assert found.kernel.wavenumber == pytest.approx(25.0, rel=0.05)
    assert found.noise_px == pytest.approx(0.02, rel=0.15)
    again, same = field_scale(X, residual, NOTHING_FREE, found)
    assert again.kernel.wavenumber == pytest.approx(found.kernel.wavenumber, rel=1e-2)
    assert same == pytest.approx(likelihood, abs=0.1)
    smooth, _ = field_scale(X, np.exp(X[:, :2]) + noise, NOTHING_FREE)
    assert smooth.kernel.wavenumber == 0.0


def three_waves(wavenumber: float, seed: int) -> tuple[np.ndarray, np.ndarray]:
    """Return places and waves of one period, any direction and phase, with noise."""
    random = np.random.default_rng(seed)
    x = random.uniform(0.0, 1.0, (140, 3)) * [0.6, 0.6, 1.0]
    angle, phase, turn = random.uniform(0.0, 2.0 * np.pi, (3, 3))
    height = np.sin(wavenumber * x[:, :2] @ np.stack([np.cos(angle), np.sin(angle)]) + phase)
    waves = 3.0 * np.stack([height @ np.cos(turn), height @ np.sin(turn)], axis=1)
    return x, waves + 0.02 * random.standard_normal((140, 2))


def test_trains_that_cross_the_picture_are_not_missed_for_short_ones() -> None:
    x, residual = three_waves(41.0, 0)
    found, _ = field_scale(x, residual, np.zeros((140, 2, 0)))
    assert found.kernel.wavenumber == pytest.approx(41.0, rel=0.005)
    assert found.kernel.across > 1.0
    assert found.noise_px == pytest.approx(0.02, rel=0.15)


@EITHER
def test_slopes_are_those_of_the_field(kernel: FieldKernel) -> None:
    field = PixelField(FieldScale(kernel, 1.3, 0.1, 0.0), X, wavy(X))
    found = field.slopes(ASKED)
    for number in range(3):
        step = np.zeros(3)
        step[number] = 1e-5
        slope = (field.at(ASKED + step) - field.at(ASKED - step)) / 2e-5
        np.testing.assert_allclose(found[:, :, number], slope, atol=1e-6 * np.abs(slope).max())


@pytest.mark.parametrize("hyperparameters", [[50.0, 0.3, 1.2], [50.0, 0.9, 1.2, 25.0]])
def test_slopes_of_the_likelihood_are_those_of_its_cost(hyperparameters: list[float]) -> None:
    by_camera = RANDOM.standard_normal((150, 2, 4))
    likelihood = _Restricted(X, wavy(X) + 0.1 * RANDOM.standard_normal((150, 2)), by_camera)
    logs = np.log(hyperparameters)
    cost, slopes = likelihood.cost_and_slopes(logs)
    assert cost == pytest.approx(likelihood.cost(logs))
    for number in range(len(logs)):
        step = np.zeros(len(logs))
        step[number] = 1e-5
        slope = (likelihood.cost(logs + step) - likelihood.cost(logs - step)) / 2e-5
        assert slopes[number] == pytest.approx(slope, rel=1e-4)


def test_the_likelihood_is_that_of_scikit_learn_where_no_camera_is_free() -> None:
    residual = wavy(X) + 0.1 * RANDOM.standard_normal((150, 2))
    likelihood = _Restricted(X, residual, NOTHING_FREE)

    def theirs(logs: np.ndarray) -> float:
        ratio, across, along = np.exp(logs)
        noise = likelihood.noise(logs)
        kernel = ConstantKernel(ratio * noise**2) * RBF([across, across, along])
        model = GaussianProcessRegressor(kernel, alpha=noise**2, optimizer=None).fit(X, residual)
        return -float(model.log_marginal_likelihood_value_)

    first, second = np.log([50.0, 0.3, 1.2]), np.log([200.0, 0.2, 2.0])
    ours = likelihood.cost(first) - likelihood.cost(second)
    assert ours == pytest.approx(theirs(first) - theirs(second), rel=1e-9)


def test_white_noise_asks_for_no_field_and_a_wave_does() -> None:
    by_camera = np.concatenate([np.tile(np.eye(2), (150, 1, 1)), X[:, None, :] * [[1.0], [0.0]]], axis=2)
    noise = 0.05 * RANDOM.standard_normal((150, 2))
    without, _ = field_scale(X, noise, by_camera)
    assert (without.amplitude_px, without.gain) == (0.0, 0.0)
    assert without.noise_px == pytest.approx(0.05, rel=0.15)
    found, likelihood = field_scale(X, wavy(X) + noise, by_camera)
    assert found.gain > 100.0
    assert found.noise_px == pytest.approx(0.05, rel=0.2)
    nowhere = _Restricted(X, wavy(X) + noise, by_camera).cost(np.array([-np.inf, 0.0, 0.0]))
    assert likelihood == pytest.approx(found.gain - nowhere)
