"""The field's numerics against scikit-learn's Gaussian process, and against differences."""

from dataclasses import replace

import numpy as np
import pytest
from sklearn.gaussian_process import GaussianProcessRegressor
from sklearn.gaussian_process.kernels import RBF, ConstantKernel

from labcal.estimators.gp_field.evidence import FieldScale, field_scale
from labcal.estimators.gp_field.kernel import FieldKernel
from labcal.estimators.gp_field.pixel_field import PixelField
from labcal.estimators.gp_field.restricted import RestrictedLikelihood
from labcal.estimators.gp_field.waves import ALL_ALIKE, AllDirections, SomeDirections, Spread

RANDOM = np.random.default_rng(4)
X = RANDOM.uniform(0.0, 1.0, (150, 3))
ASKED = RANDOM.uniform(0.0, 1.0, (30, 3))
KERNEL = FieldKernel(across=0.3, along=1.2)
WAVES = FieldKernel(0.9, 1.2, AllDirections(25.0))
SPREAD = Spread((0.2, 1.1, 2.9), (0.5, 0.3, 0.2))
PLANE_WAVES = FieldKernel(0.9, 1.2, SomeDirections(25.0, SPREAD))
EACH = pytest.mark.parametrize("kernel", [KERNEL, WAVES, PLANE_WAVES], ids=["smooth", "waves", "plane waves"])
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


def test_plane_waves_in_every_direction_are_those_of_all_directions() -> None:
    turns = np.pi * np.arange(100) / 100
    every = SomeDirections(25.0, Spread(tuple(turns), (0.01,) * 100))
    np.testing.assert_allclose(
        every.between(ASKED[:, :2], X[:, :2]), AllDirections(25.0).between(ASKED[:, :2], X[:, :2]), atol=1e-9
    )


def test_the_directions_of_plane_waves_are_found_and_lower_the_error_between_the_points() -> None:
    """Three plane waves: with all directions alike the same points tell a third less."""
    random = np.random.default_rng(7)
    turns = np.array([0.3, 1.2, 2.4])
    x, asked = random.uniform(0.0, 1.0, (2, 150, 3))

    def waves(at: np.ndarray) -> np.ndarray:
        phase = 25.0 * at[:, :2] @ np.stack([np.cos(turns), np.sin(turns)])
        return np.stack([np.sin(phase) @ [1.0, 0.5, -1.0], np.cos(phase) @ [0.7, -1.0, 0.4]], axis=1)

    residual = waves(x) + 0.02 * random.standard_normal((150, 2))
    scale = field_scale(x, residual, NOTHING_FREE).scale
    assert scale.kernel.waves is not None
    spread = scale.kernel.waves.spread
    nearest = np.abs(np.array(spread.directions)[:, None] - turns).argmin(axis=1)
    off = np.abs(np.array(spread.directions) - turns[nearest])
    assert (off * np.array(spread.shares)).sum() < 0.05
    assert {0, 1, 2} == set(nearest)
    alike = replace(scale, kernel=replace(scale.kernel, waves=AllDirections(scale.kernel.wavenumber)))
    errors = [
        np.sqrt(((PixelField(one, x, residual).at(asked) - waves(asked)) ** 2).mean())
        for one in (scale, alike)
    ]
    assert errors[0] < 0.7 * errors[1]


def test_waves_from_everywhere_keep_all_directions() -> None:
    random = np.random.default_rng(8)
    turns, phases = random.uniform(0.0, 2.0 * np.pi, (2, 200))
    phase = 25.0 * X[:, :2] @ np.stack([np.cos(turns), np.sin(turns)]) + phases
    residual = np.stack([np.sin(phase).mean(axis=1), np.cos(phase).mean(axis=1)], axis=1)
    scale = field_scale(X, 10.0 * residual + 0.02 * random.standard_normal((150, 2)), NOTHING_FREE).scale
    assert scale.kernel.waves is not None
    assert scale.kernel.waves.spread == ALL_ALIKE


@pytest.mark.slow
def test_the_period_of_waves_is_found_and_a_smooth_field_has_none() -> None:
    """Three waves of one period and any direction, as glass has them."""
    noise = 0.02 * RANDOM.standard_normal((150, 2))
    directions = 25.0 * np.array([[1.0, 0.0], [-0.6, 0.8], [0.28, 0.96]])
    phases = X[:, :2] @ directions.T
    residual = np.stack([np.sin(phases).sum(axis=1), np.cos(phases + 1.0).sum(axis=1)], axis=1) + noise
    first = field_scale(X, residual, NOTHING_FREE)
    found = first.scale
    assert found.kernel.wavenumber == pytest.approx(25.0, rel=0.05)
    assert found.noise_px == pytest.approx(0.02, rel=0.15)
    again = field_scale(X, residual, NOTHING_FREE, found)
    assert again.scale.kernel.wavenumber == pytest.approx(found.kernel.wavenumber, rel=1e-2)
    assert again.likelihood == pytest.approx(first.likelihood, abs=0.5)
    smooth = field_scale(X, np.exp(X[:, :2]) + noise, NOTHING_FREE)
    assert smooth.scale.kernel.wavenumber == 0.0


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
    found = field_scale(x, residual, np.zeros((140, 2, 0))).scale
    assert found.kernel.wavenumber == pytest.approx(41.0, rel=0.005)
    assert found.kernel.across > 1.0
    assert found.noise_px == pytest.approx(0.02, rel=0.15)


@EACH
def test_slopes_are_those_of_the_field(kernel: FieldKernel) -> None:
    field = PixelField(FieldScale(kernel, 1.3, 0.1, 0.0), X, wavy(X))
    found = field.slopes(ASKED)
    for number in range(3):
        step = np.zeros(3)
        step[number] = 1e-5
        slope = (field.at(ASKED + step) - field.at(ASKED - step)) / 2e-5
        np.testing.assert_allclose(found[:, :, number], slope, atol=1e-6 * np.abs(slope).max())


@pytest.mark.parametrize(
    ("hyperparameters", "spread"),
    [([50.0, 0.3, 1.2], ALL_ALIKE), ([50.0, 0.9, 1.2, 25.0], ALL_ALIKE), ([50.0, 0.9, 1.2, 25.0], SPREAD)],
)
def test_slopes_of_the_likelihood_are_those_of_its_cost(hyperparameters: list[float], spread: Spread) -> None:
    by_camera = RANDOM.standard_normal((150, 2, 4))
    residual = wavy(X) + 0.1 * RANDOM.standard_normal((150, 2))
    likelihood = RestrictedLikelihood(X, residual, by_camera, spread)
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
    likelihood = RestrictedLikelihood(X, residual, NOTHING_FREE)

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
    without = field_scale(X, noise, by_camera).scale
    assert (without.amplitude_px, without.gain) == (0.0, 0.0)
    assert without.noise_px == pytest.approx(0.05, rel=0.15)
    likely = field_scale(X, wavy(X) + noise, by_camera)
    found = likely.scale
    assert found.gain > 100.0
    assert found.noise_px == pytest.approx(0.05, rel=0.2)
    nowhere = RestrictedLikelihood(X, wavy(X) + noise, by_camera).cost(np.array([-np.inf, 0.0, 0.0]))
    assert likely.likelihood == pytest.approx(found.gain - nowhere)
