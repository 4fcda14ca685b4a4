"""Methods of one's own: regressors of scikit-learn, pipelines, and classes that it does not know."""

import sys
from collections.abc import Callable, Iterator
from pathlib import Path

import numpy as np
import pytest
from sklearn.ensemble import RandomForestRegressor
from sklearn.gaussian_process import GaussianProcessRegressor
from sklearn.gaussian_process.kernels import RBF
from sklearn.linear_model import LinearRegression, Ridge
from sklearn.neighbors import KNeighborsRegressor
from sklearn.pipeline import make_pipeline
from sklearn.preprocessing import PolynomialFeatures, StandardScaler
from sklearn.svm import SVR

from labcal.errors import InputError, InputTypeError, UnknownNameError
from labcal.estimators import registry
from labcal.estimators.affine import Affine
from labcal.estimators.estimator import FittedArray, PointEstimator
from labcal.estimators.fit_settings import FitSettings
from labcal.estimators.fitting import estimators_of
from labcal.estimators.hybrid import Hybrid
from labcal.estimators.method_choice import estimator_of
from labcal.estimators.model import Model, TrainingBox
from labcal.estimators.model_file import load_model, save_model, training_views
from labcal.estimators.registry import make_estimator, method_names, register_method
from labcal.estimators.user_method import UserMethod

View = Callable[[np.ndarray], np.ndarray]
PIPELINE = make_pipeline(StandardScaler(), PolynomialFeatures(2), Ridge(1e-4))


class Plain:
    """A method of somebody who has never heard of scikit-learn: the mean of what was fitted."""

    def fit(self, X: np.ndarray, Y: np.ndarray) -> None:  # noqa: ARG002 - the form of a method
        self.mean = Y.mean(axis=0)

    def predict(self, X: np.ndarray) -> np.ndarray:
        return np.tile(self.mean, (len(X), 1))


class Flat(Plain):
    def predict(self, X: np.ndarray) -> np.ndarray:
        return np.zeros(len(X))


class Broken(Plain):
    def predict(self, X: np.ndarray) -> np.ndarray:  # noqa: ARG002 - the form of a method
        return {}["nothing"]


class Moody(Plain):
    """Random, and without a seed that could be given."""

    def predict(self, X: np.ndarray) -> np.ndarray:
        return super().predict(X) + np.random.default_rng().normal(size=(len(X), 3))


class Median(PointEstimator):
    """The middle of all points that were fitted.

    A whole method in labcal's own form.
    """

    method = "median"

    def fitted_arrays(self) -> tuple[FittedArray, ...]:
        return (FittedArray("median_", (self.n_outputs_,)),)

    def _fit(self, pixels: np.ndarray, points: np.ndarray) -> None:  # noqa: ARG002 - the form of a method
        self.median_ = np.median(points, axis=0)

    def _predict(self, pixels: np.ndarray) -> np.ndarray:
        return np.tile(self.median_, (len(pixels), 1))


@pytest.fixture
def own_module(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Iterator[str]:
    """A module of a user's; other methods are forgotten afterwards."""
    (tmp_path / "users_own_methods.py").write_text(
        "from sklearn.linear_model import Ridge\n"
        "from sklearn.pipeline import make_pipeline\n"
        "from sklearn.preprocessing import PolynomialFeatures, StandardScaler\n"
        "ready = make_pipeline(StandardScaler(), PolynomialFeatures(2), Ridge(1e-4))\n"
        "def made():\n    return ready\n"
        "class Sum:\n    def fit(self, X, Y): pass\n"
    )
    (tmp_path / "users_broken_module.py").write_text("import users_missing_module\n")
    (tmp_path / "users_raising_module.py").write_text("raise RuntimeError('no licence')\n")
    monkeypatch.syspath_prepend(str(tmp_path))
    yield "users_own_methods"
    sys.modules.pop("users_own_methods", None)


@pytest.fixture
def clean_registry(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(registry, "_REGISTERED", {})


def noisy(stereo: View, volume: np.ndarray) -> np.ndarray:
    return stereo(volume) + 0.1 * np.random.default_rng(3).normal(size=(len(volume), 4))


@pytest.mark.parametrize(
    "given",
    [
        LinearRegression(),
        KNeighborsRegressor,
        RandomForestRegressor(n_estimators=4),
        SVR,  # one output only: fitted once for each coordinate
        PIPELINE,
        "sklearn.linear_model:Ridge",
    ],
    ids=str,
)
def test_any_regressor_learns_and_predicts_what_scikit_learn_alone_predicts(
    given: object, stereo: View, volume: np.ndarray, other_volume: np.ndarray
) -> None:
    X, asked = noisy(stereo, volume), stereo(other_volume)
    estimator = estimator_of(given).fit(X, volume)
    found, covariance = estimator.predict_with_covariance(
        asked, np.tile(0.01 * np.eye(2), (len(asked), 2, 1, 1))
    )
    assert found.shape == other_volume.shape
    assert (found == estimator.predict(asked)).all()
    assert np.isfinite(covariance).all()
    assert (np.linalg.eigvalsh(covariance) > 0).all()
    if isinstance(given, LinearRegression):
        assert found == pytest.approx(LinearRegression().fit(X, volume).predict(asked), rel=1e-9)
    if given is SVR:
        alone = np.column_stack([SVR().fit(X, column).predict(asked) for column in volume.T])
        assert found == pytest.approx(alone, rel=1e-9)


def test_what_is_given_stays_as_it_was(stereo: View, volume: np.ndarray) -> None:
    given = RandomForestRegressor(n_estimators=2)
    before = (dict(vars(given)), given.get_params())
    estimator_of(given).fit(stereo(volume), volume)
    assert (vars(given), given.get_params()) == before
    settings = FitSettings(lens="pinhole", seed=5)
    own = Hybrid(lens="brown5")
    (kept,) = estimators_of([own], settings)
    assert (kept.get_params()["lens"], own.lens) == ("brown5", "brown5")
    (named,) = estimators_of(["hybrid"], settings)
    assert named.get_params()["lens"] == "pinhole"
    (seeded,) = estimators_of([given], settings)
    assert seeded.fit(stereo(volume), volume).regressor_.random_state == 5
    (of_its_own,) = estimators_of([RandomForestRegressor(n_estimators=2, random_state=9)], settings)
    assert of_its_own.fit(stereo(volume), volume).regressor_.random_state == 9


def test_the_covariance_is_that_of_errors_on_dots_held_out(
    stereo: View, volume: np.ndarray, other_volume: np.ndarray
) -> None:
    # A nearest neighbour makes no error at all on what it was trained on.
    estimator = estimator_of(KNeighborsRegressor(1)).fit(stereo(volume), volume)
    assert estimator.predict(stereo(volume)) == pytest.approx(volume)
    error = estimator.predict(stereo(other_volume)) - other_volume
    stated = np.sqrt(np.trace(estimator.residual_covariance_))
    assert stated == pytest.approx(np.sqrt((error**2).sum(axis=1).mean()), rel=0.2)
    # A linear one: chi-square of independent errors has the mean of its three degrees of freedom.
    linear = estimator_of(LinearRegression()).fit(stereo(volume), volume)
    error = linear.predict(stereo(other_volume)) - other_volume
    chi2 = np.einsum("ni,ij,nj->n", error, np.linalg.inv(linear.residual_covariance_), error)
    assert chi2.mean() == pytest.approx(3.0, abs=0.6)


def test_where_nothing_can_be_held_out_the_covariance_is_not_a_number(
    stereo: View, volume: np.ndarray, tmp_path: Path
) -> None:
    X, Y = stereo(volume[:5]), volume[:5]  # five neighbours of five dots, but of four there are four
    estimator = estimator_of(KNeighborsRegressor(5)).fit(X, Y)
    assert np.isnan(estimator.predict_with_covariance(X, np.zeros((5, 2, 2, 2)))[1]).all()
    path = tmp_path / "m"
    save_model(path, model(estimator, X, Y), force=False)
    loaded = load_model(path, KNeighborsRegressor(5)).estimator
    assert np.isnan(loaded.predict_with_covariance(X, np.zeros((5, 2, 2, 2)))[1]).all()
    assert (loaded.predict(X) == estimator.predict(X)).all()


@pytest.mark.parametrize(
    ("given", "said"),
    [
        (Flat, r"'predict' gave an array of shape \(300,\).*should be \(300, 3\)"),
        (Broken, "its 'predict' failed .KeyError: 'nothing'"),
        (KNeighborsRegressor(400), "its 'predict' failed .ValueError: Expected n_neighbors"),
        (Ridge(-1.0), "its 'fit' failed .InvalidParameterError"),
    ],
    ids=str,
)
def test_what_goes_wrong_in_it_is_told_as_its_own_fault(
    given: object, said: str, stereo: View, volume: np.ndarray
) -> None:
    with pytest.raises(InputError, match=said):
        estimator_of(given).fit(stereo(volume), volume)


@pytest.mark.parametrize(
    ("given", "said"),
    [
        ("no_such_package.module:Class", "There is no module 'no_such_package'"),
        ("sklearn.no_such_module:Class", "There is no module 'sklearn.no_such_module'"),
        (
            "sklearn.linear_model:Rigde",
            "no class in 'sklearn.linear_model' named 'Rigde'. Did you mean 'Ridge'",
        ),
        ("sklearn.linear_model:Ridge()", r"Its form is package\.module:Class"),
        (":Class", r"Its form is package\.module:Class"),
        ("os:path", "'os:path' is no method: it has no 'fit' and 'predict'"),
        ("users_own_methods:Sum", "'users_own_methods:Sum' is no method"),
        ("sklearn.pipeline:Pipeline", "cannot be made without arguments: it failed .TypeError.*'steps'"),
        (
            "users_broken_module:Class",
            "cannot be imported .ModuleNotFoundError: No module named 'users_missing_module'",
        ),
        ("users_raising_module:Class", "cannot be imported .RuntimeError: no licence"),
        ("rigde", "There is no method named 'rigde'"),
        (7, "'builtins:int' is no method"),
    ],
    ids=str,
)
@pytest.mark.usefixtures("own_module")
def test_a_method_that_is_none_is_refused_with_what_to_do(given: object, said: str) -> None:
    with pytest.raises(InputError, match=said):
        estimator_of(given)


def test_a_module_may_hold_a_class_a_pipeline_or_a_function_that_makes_one(
    own_module: str, stereo: View, volume: np.ndarray
) -> None:
    expected = estimator_of(PIPELINE).fit(stereo(volume), volume).predict(stereo(volume))
    for name in ("ready", "made"):
        estimator = estimator_of(f"{own_module}:{name}").fit(stereo(volume), volume)
        assert estimator.method == f"{own_module}:{name}"
        assert (estimator.predict(stereo(volume)) == expected).all()
    own = estimator_of(f"{__name__}:Plain") if __name__ in sys.modules else estimator_of(Plain)
    assert own.fit(stereo(volume), volume).predict(stereo(volume))[0] == pytest.approx(volume.mean(axis=0))
    assert type(estimator_of("labcal.estimators.affine:Affine")) is Affine  # needs nothing around it


def model(estimator: PointEstimator, X: np.ndarray, Y: np.ndarray) -> Model:
    sizes = ((640, 480), (640, 480))
    return Model(estimator, ("left", "right"), sizes, TrainingBox.of(X, Y), calibrated_on=("a", "b"))


@pytest.mark.parametrize(
    "given",
    [
        PIPELINE,
        RandomForestRegressor(n_estimators=3),
        SVR,
        Plain,
        GaussianProcessRegressor(RBF(100.0), alpha=1e-3),
    ],
    ids=str,
)
def test_a_model_is_fitted_again_when_the_reader_names_the_method(
    given: object, tmp_path: Path, stereo: View, volume: np.ndarray, other_volume: np.ndarray
) -> None:
    X, asked = noisy(stereo, volume), stereo(other_volume)
    (estimator,) = estimators_of([given], FitSettings(seed=4))
    estimator.fit(X, volume)
    path = tmp_path / "m"
    save_model(path, model(estimator, X, volume), force=False)
    loaded = load_model(path, given)
    assert loaded.calibrated_on == training_views(path) == ("a", "b")
    assert loaded.estimator.method == estimator.method
    assert loaded.estimator.predict(asked) == pytest.approx(estimator.predict(asked), abs=1e-6)
    assert (loaded.estimator.residual_covariance_ == estimator.residual_covariance_).all()
    again = tmp_path / "again"
    save_model(again, loaded, force=False)
    assert again.read_bytes() == path.read_bytes()


def test_a_file_alone_makes_nothing_be_imported(
    own_module: str, tmp_path: Path, stereo: View, volume: np.ndarray
) -> None:
    estimator = estimator_of(f"{own_module}:made").fit(stereo(volume), volume)
    path = tmp_path / "m"
    save_model(path, model(estimator, stereo(volume), volume), force=False)
    del sys.modules[own_module]
    with pytest.raises(InputError, match=f"is never run by itself.*`method='{own_module}:made'`"):
        load_model(path)
    assert own_module not in sys.modules
    assert training_views(path) == ("a", "b")
    assert own_module not in sys.modules
    loaded = load_model(path, f"{own_module}:ready")  # another name of the same
    assert (loaded.estimator.predict(stereo(volume)) == estimator.predict(stereo(volume))).all()


def test_another_method_than_the_models_is_refused(tmp_path: Path, stereo: View, volume: np.ndarray) -> None:
    X = stereo(volume)
    path, own, moody = tmp_path / "m", tmp_path / "own", tmp_path / "moody"
    save_model(path, model(estimator_of(Ridge(2.0)).fit(X, volume), X, volume), force=False)
    save_model(own, model(make_estimator("affine").fit(X, volume), X, volume), force=False)
    save_model(moody, model(estimator_of(Moody).fit(X, volume), X, volume), force=False)
    assert isinstance(load_model(path, Ridge(2.0)).estimator, UserMethod)
    with pytest.raises(InputError, match=r"fitted with alpha = 2\.0, but the method that is named has 1\.0"):
        load_model(path, "sklearn.linear_model:Ridge")
    with pytest.raises(InputError, match=r"of the class 'sklearn.linear_model\._base:LinearRegression'"):
        load_model(path, LinearRegression)
    with pytest.raises(InputError, match="Name that one"):
        load_model(path, "affine")
    with pytest.raises(InputError, match=r"fitted with 'affine', not with .*Name no method"):
        load_model(own, Ridge())
    with pytest.raises(InputError, match="is random without a 'random_state'"):
        load_model(moody, Moody)


@pytest.mark.usefixtures("clean_registry")
def test_a_method_in_labcals_own_form_is_registered_from_outside(
    tmp_path: Path, stereo: View, volume: np.ndarray
) -> None:
    path, X = tmp_path / "m", stereo(volume)
    save_model(path, model(Median().fit(X, volume), X, volume), force=False)
    with pytest.raises(UnknownNameError, match="no method named 'median'"):
        load_model(path)
    assert (load_model(path, Median).estimator.predict(X) == np.median(volume, axis=0)).all()
    assert register_method(Median) is Median
    assert "median" in method_names()
    assert registry.method_entries()["median"].summary == "The middle of all points that were fitted."
    assert type(make_estimator("median")) is Median
    assert (load_model(path).estimator.predict(X) == np.median(volume, axis=0)).all()
    register_method(Median)  # a cell of a notebook, run again


@pytest.mark.usefixtures("clean_registry")
def test_what_cannot_be_registered_is_refused() -> None:
    with pytest.raises(InputTypeError, match="subclass of PointEstimator"):
        register_method(Ridge)
    with pytest.raises(
        InputTypeError, match="no whole method: it lacks method, fitted_arrays, _fit, _predict"
    ):
        register_method(PointEstimator)
    with pytest.raises(InputError, match="'affine' is a name of labcal's already"):
        register_method(type("Other", (Median,), {"method": "affine"}))
    with pytest.raises(InputError, match="letters, digits and hyphens"):
        register_method(type("Other", (Median,), {"method": "a:b"}))
