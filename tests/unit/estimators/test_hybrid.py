"""The hybrid and the bundle on cameras that a lens formula explains, and on ones that none does."""

import json
from collections.abc import Callable
from pathlib import Path

import numpy as np
import pytest
from sklearn.base import clone

from labcal.cameras.camera import Camera
from labcal.cameras.triangulation import triangulate
from labcal.cameras.window import WATER, FlatWindow, Wave, WavyWindow
from labcal.errors import InputError
from labcal.estimators.bundle import Bundle
from labcal.estimators.gp_field.waves import AllDirections
from labcal.estimators.hybrid import Hybrid
from labcal.estimators.model import Model, TrainingBox
from labcal.estimators.model_file import load_model, save_model
from labcal.estimators.surrogate_validation import Surrogate, fit_unless_surrogate, surrogate_of, validate_on
from labcal.evaluate.statistics import coverage
from labcal.geometry.poses import look_at

View = Callable[[np.ndarray], np.ndarray]
SIZE, SIGMA = (1280, 960), 0.05
SIZES = (SIZE, SIZE)
K = np.array([[1000.0, 0.0, 640.3], [0.0, 1000.0, 478.2], [0.0, 0.0, 1.0]])
PANE = WavyWindow(
    waves=(
        Wave(amplitude_px=(3.0, -1.0), period_px=300.0, direction_deg=20.0),
        Wave(amplitude_px=(1.0, 2.0), period_px=300.0, direction_deg=100.0, phase_deg=50.0),
    )
)


def pair(window: FlatWindow | WavyWindow | None) -> list[Camera]:
    focus, up = np.array([1000.0, 1000.0, 500.0]), np.array([0.0, 1.0, 0.0])
    return [
        Camera(
            K, "pinhole", np.zeros(5), look_at(np.array([x, 700.0, 2400.0]), focus, up), SIZE, window=window
        )
        for x in (650.0, 1350.0)
    ]


class Simulated:
    """Four planes of dots to train on, and points between them."""

    def __init__(self, cameras: list[Camera], seed: int) -> None:
        random = np.random.default_rng(seed)
        x, y, z = np.meshgrid(np.linspace(650, 1350, 13), np.linspace(650, 1350, 10), np.linspace(0, 1000, 4))
        self.Y = np.stack([x.ravel(), y.ravel(), z.ravel()], axis=1)
        self.p = random.uniform((650, 650, 0), (1350, 1350, 1000), (1000, 3))
        self.X, self.q = (
            (q := np.stack([camera.project(p).q for camera in cameras], axis=1))
            + SIGMA * random.standard_normal(q.shape)
            for p in (self.Y, self.p)
        )
        self.covariance = np.tile(SIGMA**2 * np.eye(2), (1000, 2, 1, 1))
        self.oracle = rms(triangulate(cameras, self.q, self.covariance).point - self.p)

    @property
    def training(self) -> tuple[np.ndarray, np.ndarray]:
        return self.X.reshape(len(self.X), -1), self.Y

    def outcome(self, estimator: Bundle | Hybrid) -> tuple[float, float]:
        """Return the error over the oracle's, and the coverage."""
        found, stated = estimator.predict_with_covariance(self.q.reshape(1000, -1), self.covariance)
        return rms(found - self.p) / self.oracle, coverage(found - self.p, stated)


def rms(error: np.ndarray) -> float:
    return float(np.sqrt((error**2).sum(axis=1).mean()))


@pytest.fixture(scope="module")
def waves() -> Simulated:
    return Simulated(pair(PANE), 1)


@pytest.fixture(scope="module")
def surrogate(waves: Simulated) -> Surrogate:
    found = surrogate_of(*waves.training, SIZES, lens="pinhole")
    assert found is not None
    return found


@pytest.fixture(scope="module")
def hybrid(surrogate: Surrogate) -> Hybrid:
    return surrogate.hybrid


@pytest.mark.slow
def test_waves_are_learned_and_their_uncertainty_known(waves: Simulated, hybrid: Hybrid) -> None:
    ratio, covered = waves.outcome(hybrid)
    assert ratio <= 1.10
    assert 0.93 <= covered <= 0.97
    assert (hybrid.field_px_ > 1.0).all()
    ratio, covered = waves.outcome(Bundle("pinhole", SIZES).fit(*waves.training))
    assert ratio > 10.0
    assert covered < 0.5


def test_the_directions_of_waves_are_kept_in_a_models_file_and_older_files_have_none(
    waves: Simulated, hybrid: Hybrid, tmp_path: Path
) -> None:
    for camera in hybrid.fitted_cameras_:
        assert camera.fitted is not None
        found = camera.fitted.field.scale.kernel.waves
        assert found is not None
        assert found.wavenumber * 300.0 / SIZE[0] == pytest.approx(2.0 * np.pi, rel=0.01)
        largest = np.degrees(found.spread.directions)[np.argsort(found.spread.shares)[-4:]]
        assert np.abs(largest[:, None] - [20.0, 100.0]).min(axis=0).max() < 5.0
    model = Model(hybrid, ("left", "right"), SIZES, TrainingBox.of(*waves.training))
    save_model(tmp_path / "model", model, force=False)
    asked = waves.q[:50].reshape(50, -1)
    assert (
        load_model(tmp_path / "model").estimator.predict(asked).tobytes() == hybrid.predict(asked).tobytes()
    )
    older = load_model(tmp_path / "model").estimator
    assert isinstance(older, Hybrid)
    content = json.loads(older.cameras_text_)
    del content["waves"]
    older.cameras_text_ = json.dumps(content)
    for camera in older.fitted_cameras_:
        assert camera.fitted is not None
        assert isinstance(camera.fitted.field.scale.kernel.waves, AllDirections)


def test_where_the_lens_is_right_there_is_no_field() -> None:
    clear = Simulated(pair(None), 2)
    hybrid = Hybrid("brown-k1k2", SIZES).fit(*clear.training)
    np.testing.assert_array_equal(hybrid.field_px_, 0.0)
    assert hybrid.predict(clear.q.reshape(1000, -1)).tobytes() == (
        Bundle("brown-k1k2", SIZES).fit(*clear.training).predict(clear.q.reshape(1000, -1)).tobytes()
    )
    ratio, covered = clear.outcome(hybrid)
    assert ratio <= 1.03
    assert 0.93 <= covered <= 0.97


@pytest.mark.slow
def test_an_unknown_medium_behind_a_window_is_an_interface_and_needs_no_field(tmp_path: Path) -> None:
    """An index between those of air and water: found, and kept in the model's file."""
    wet = Simulated(pair(FlatWindow(distance_mm=200.0, tilt_x_deg=18.0, behind_index=1.2)), 3)
    every_third = slice(None, None, 3)
    X, Y = (values[every_third] for values in wet.training)
    hybrid = Hybrid(image_sizes=SIZES).fit(X, Y)
    np.testing.assert_array_equal(hybrid.field_px_, 0.0)
    for camera in hybrid.cameras_:
        assert isinstance(camera.window, FlatWindow)
        assert camera.window.behind_index == pytest.approx(1.2, abs=0.03)
    ratio, covered = wet.outcome(hybrid)
    assert ratio <= 1.05
    assert 0.93 <= covered <= 0.97
    model = Model(hybrid, ("left", "right"), SIZES, TrainingBox.of(X, Y))
    save_model(tmp_path / "model", model, force=False)
    loaded, asked = load_model(tmp_path / "model").estimator, wet.q.reshape(1000, -1)
    for kept, made in zip(
        *(one.predict_with_covariance(asked, wet.covariance) for one in (loaded, hybrid)), strict=True
    ):
        assert kept.tobytes() == made.tobytes()


def test_training_data_alone_tell_whom_to_trust(
    waves: Simulated, hybrid: Hybrid, surrogate: Surrogate
) -> None:
    trusted, misled = (
        validate_on(hybrid, surrogate),
        validate_on(Bundle("pinhole", SIZES).fit(*waves.training), surrogate),
    )
    assert not trusted.misfit
    assert trusted.rmse_mm == pytest.approx(waves.outcome(hybrid)[0] * waves.oracle, rel=0.1)
    assert trusted.limit_mm == pytest.approx(waves.oracle, rel=0.1)
    assert misled.misfit
    assert misled.rmse_mm > 10.0 * trusted.rmse_mm
    assert misled.coverage95 < 0.5


def test_a_plane_cannot_be_rehearsed(stereo: View, plane: np.ndarray) -> None:
    assert surrogate_of(stereo(plane), plane, ((640, 480), (640, 480))) is None


def test_a_saved_field_predicts_the_same_bytes(waves: Simulated, hybrid: Hybrid, tmp_path: Path) -> None:
    model = Model(hybrid, ("left", "right"), SIZES, TrainingBox.of(*waves.training))
    save_model(tmp_path / "model", model, force=False)
    read = load_model(tmp_path / "model")
    assert read.field_px == model.field_px
    assert read.field_note is None  # both cameras have one
    loaded, asked = read.estimator, waves.q.reshape(1000, -1)
    first, second = (one.predict_with_covariance(asked, waves.covariance) for one in (hybrid, loaded))
    assert first[0].tobytes() == second[0].tobytes()
    assert first[1].tobytes() == second[1].tobytes()


def test_three_cameras_and_no_picture_sizes(three_cameras: View, volume: np.ndarray) -> None:
    seen = three_cameras(volume)
    estimator = clone(Bundle("pinhole")).fit(seen[:200], volume[:200])
    np.testing.assert_allclose(estimator.predict(seen[200:]), volume[200:], atol=1e-3)
    assert len(estimator.cameras_) == 3


def test_what_cannot_be_fitted_is_refused(stereo: View, volume: np.ndarray, plane: np.ndarray) -> None:
    X = stereo(volume)
    with pytest.raises(InputError, match="one camera"):
        Bundle().fit(X[:, :2], volume)
    with pytest.raises(InputError, match="one plane"):
        Bundle().fit(stereo(plane), plane)
    with pytest.raises(InputError, match="1 picture,"):
        Bundle(image_sizes=((640, 480),)).fit(X, volume)
    with pytest.raises(InputError, match="NaN"):
        Hybrid().fit(np.where(X[3, 1] == X, np.nan, X), volume)


def test_the_twins_own_method_is_not_fitted_twice(waves: Simulated, surrogate: Surrogate) -> None:
    assert fit_unless_surrogate(surrogate, Hybrid("pinhole", SIZES), *waves.training) is surrogate.hybrid
    bundle, other = Bundle("pinhole", SIZES), Hybrid("brown-k1k2", SIZES)
    assert fit_unless_surrogate(surrogate, bundle, *waves.training) is bundle
    assert fit_unless_surrogate(surrogate, other, *(values[::3] for values in waves.training)) is other


@pytest.mark.slow
def test_a_tilted_window_far_from_where_the_search_begins_is_found() -> None:
    wet = Simulated(pair(FlatWindow(distance_mm=200.0, tilt_x_deg=30.0, behind_index=WATER)), 3)
    estimator = Bundle("pinhole", SIZES, behind_index=WATER).fit(*wet.training)
    for camera in estimator.cameras_:
        assert isinstance(camera.window, FlatWindow)
        assert camera.window.distance_mm == pytest.approx(200.0, rel=0.01)
        assert camera.window.tilt_x_deg == pytest.approx(30.0, abs=0.2)
        assert camera.window.tilt_y_deg == pytest.approx(0.0, abs=0.2)
    ratio, covered = wet.outcome(estimator)
    assert ratio <= 1.03
    assert 0.93 <= covered <= 0.97
