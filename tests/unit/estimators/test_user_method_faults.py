"""Methods of a user's that are wrong: each fault is an error that names the method and the part."""

import sys
import threading
from collections.abc import Callable, Iterator
from pathlib import Path
from typing import Any

import jaxtyping
import numpy as np
import pandas as pd
import pytest

from labcal.errors import InputError, InputTypeError, LabcalError
from labcal.estimators import registry
from labcal.estimators.estimator import FittedArray, PointEstimator
from labcal.estimators.fit_settings import FitSettings
from labcal.estimators.fitting import estimators_of
from labcal.estimators.method_choice import estimator_of
from labcal.estimators.model import Model, TrainingBox
from labcal.estimators.model_file import save_model
from labcal.estimators.registry import register_method

View = Callable[[np.ndarray], np.ndarray]


@pytest.fixture(autouse=True)
def unchecked_types(monkeypatch: pytest.MonkeyPatch) -> Iterator[None]:
    """Let through what the tests' checker of annotations would refuse before labcal can."""
    monkeypatch.setattr(registry, "_REGISTERED", {})
    jaxtyping.config.update("jaxtyping_disable", True)
    yield
    jaxtyping.config.update("jaxtyping_disable", False)


class Mean:
    def fit(self, X: np.ndarray, Y: np.ndarray) -> None:  # noqa: ARG002 - the form of a method
        self.mean = Y.mean(axis=0)

    def predict(self, X: np.ndarray) -> np.ndarray:
        return np.tile(self.mean, (len(X), 1))


def mean_with(**methods: Any) -> type[Mean]:  # noqa: ANN401 -- of any form
    """Return a class with other methods."""
    return type("Mine", (Mean,), methods)


class Own(PointEstimator):
    """The mean, in labcal's own form."""

    method = "own"

    def fitted_arrays(self) -> tuple[FittedArray, ...]:
        return (FittedArray("mean_", (self.n_outputs_,)),)

    def _fit(self, pixels: np.ndarray, points: np.ndarray) -> None:  # noqa: ARG002 - the form of a method
        self.mean_ = points.mean(axis=0)

    def _predict(self, pixels: np.ndarray) -> np.ndarray:
        return np.tile(self.mean_, (len(pixels), 1))


def own_with(**methods: Any) -> type[Own]:  # noqa: ANN401 -- of any form
    """Return a class with other methods, of a module that is none of labcal's."""
    return type("Own", (Own,), {"__module__": __name__, **methods})


def exits(*_: object) -> None:
    sys.exit(3)


@pytest.mark.parametrize(
    ("given", "said"),
    [
        (mean_with(fit=exits), "its 'fit' failed .SystemExit: 3"),
        (mean_with(fit=lambda _self, _X: None), "its 'fit' failed .TypeError"),
        (mean_with(predict=lambda _self, _X: None), r"'predict' gave an array of shape \(\)"),
        (mean_with(predict=lambda _self, X: np.full((len(X), 3), 1e300)), "not finite, or beyond 1e.09 mm"),
        (
            mean_with(predict=lambda _self, X: np.ma.masked_array(np.zeros((len(X), 3)), mask=True)),
            "not finite, or beyond",
        ),
        (mean_with(__init__=exits), "cannot be made without arguments: it failed .SystemExit: 3"),
        (mean_with(__init__=lambda self: setattr(self, "lock", threading.Lock())), "a copy of it, .* failed"),
        (mean_with(get_params=lambda _self, deep: None), "its 'get_params' failed"),  # noqa: ARG005 -- the form
        (mean_with(__getattr__=lambda _self, name: {}[name]), "its 'get_params' failed .KeyError"),
        (PointEstimator, "no whole method: it lacks method, fitted_arrays"),
        (own_with(_fit=lambda *_: {}["k"]), "own: its 'fit' failed .KeyError: 'k'"),
        (own_with(_predict=lambda *_: {}["k"]), "own: its 'predict' failed .KeyError: 'k'"),
        (own_with(_predict=lambda _self, X: np.zeros(len(X))), r"own: 'predict' gave an array of shape \("),
        (own_with(_predict=lambda _self, X: [[0.0] * 3] * len(X)), "own: 'predict' gave list for"),
        (own_with(_predict=lambda _self, X: np.full((len(X), 3), np.nan)), "own: .* are not finite"),
    ],
)
def test_what_is_wrong_is_named(given: type, said: str, stereo: View, volume: np.ndarray) -> None:
    def fitted() -> None:
        (estimator,) = estimators_of([given], FitSettings())
        estimator.fit(stereo(volume), volume)

    with pytest.raises(LabcalError, match=said):
        fitted()


def test_a_method_that_works_in_place_changes_nothing_outside(stereo: View, volume: np.ndarray) -> None:
    def spoil(self: Mean, X: np.ndarray, Y: np.ndarray) -> None:
        self.mean = Y.mean(axis=0)
        X *= 0.0
        Y *= 0.0

    def predict(self: Mean, X: np.ndarray) -> np.ndarray:
        X *= 0.0
        return np.tile(self.mean, (len(X), 1))

    X, Y = stereo(volume), volume.copy()
    for given in (mean_with(fit=spoil, predict=predict), own_with(_fit=Own._fit)):
        before = X.copy(), Y.copy()
        estimator = estimator_of(given).fit(X, Y)
        estimator.predict(X)
        assert (before[0] == X).all()
        assert (before[1] == Y).all()
    own = estimator_of(mean_with(fit=spoil, predict=predict)).fit(X, Y)
    assert (own.trained_pixels_ == X).all()
    assert (own.trained_points_ == Y).all()

    def spoil_own(self: Own, pixels: np.ndarray, points: np.ndarray) -> None:
        self.mean_ = points.mean(axis=0)
        pixels *= 0.0
        points *= 0.0

    estimator_of(own_with(_fit=spoil_own)).fit(X, Y)
    assert (before[0] == X).all()
    assert (before[1] == Y).all()


@pytest.mark.parametrize(
    ("kind", "said"),
    [
        ("c16", "complex numbers"),
        ("?", "truth values"),
        ("U", "texts"),
        ("M8[s]", "dates"),
        ("m8[s]", "durations"),
        ([("x", "f8")], "records"),
    ],
)
@pytest.mark.parametrize("form", [mean_with, own_with])
def test_predictions_that_are_no_real_numbers_are_refused(
    form: Callable[..., type], kind: str, said: str, stereo: View, volume: np.ndarray
) -> None:
    def predict(_self: object, X: np.ndarray) -> np.ndarray:
        return np.zeros((len(X), 3)).astype(kind)

    given = form(predict=predict) if form is mean_with else form(_predict=predict)
    with pytest.raises(InputTypeError, match=f"'predict' gave {said}, but points are real numbers, in mm"):
        estimator_of(given).fit(stereo(volume), volume)


@pytest.mark.parametrize("value", [1j, "1.0", True, pd.NA, [0.0]])
def test_objects_that_are_no_real_numbers_are_refused(
    value: object, stereo: View, volume: np.ndarray
) -> None:
    def predict(_self: object, X: np.ndarray) -> np.ndarray:
        found = np.zeros((len(X), 3), dtype=object)
        found[1, 2] = value
        return found

    with pytest.raises(InputTypeError, match=f"'predict' gave an object of type {type(value).__name__}"):
        estimator_of(mean_with(predict=predict)).fit(stereo(volume), volume)


@pytest.mark.parametrize(
    "convert",
    [
        lambda found: pd.DataFrame(found, columns=list("XYZ")),
        lambda found: found.astype(object),
        lambda found: found.tolist(),
        lambda found: found.astype(np.float32),
        lambda found: found.astype(np.longdouble),
    ],
)
def test_real_numbers_of_any_type_are_taken(
    convert: Callable[[np.ndarray], object], stereo: View, volume: np.ndarray
) -> None:
    X, whole = stereo(volume), volume.round()

    def predict(self: Mean, X: np.ndarray) -> object:
        return convert(Mean.predict(self, X).round())

    estimator = estimator_of(mean_with(predict=predict)).fit(X, whole)
    found = estimator.predict(X)
    assert found.dtype == np.float64
    assert (found == whole.mean(axis=0).round()).all()


@pytest.mark.parametrize(
    ("code", "said"),
    [
        ("def f(:\n", "cannot be imported .SyntaxError"),
        ("import sys\nsys.exit(4)\n", "cannot be imported .SystemExit: 4"),
        ("raise SystemExit\n", "cannot be imported .SystemExit."),
        ("1 / 0\n", "cannot be imported .ZeroDivisionError"),
        (
            "def __getattr__(name):\n    raise RuntimeError('of a module')\n",
            "failed .RuntimeError: of a module",
        ),
        ("class Error(Exception):\n    def __str__(self):\n        1 / 0\nraise Error\n", "imported .Error."),
        ("Mine = 3\n", "is no method: it has no 'fit' and 'predict'"),
        ("class Mien:\n    fit = predict = print\n", "Did you mean 'Mien'"),
    ],
)
def test_a_module_that_is_wrong_is_named(
    code: str, said: str, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    name = f"users_faulty_{abs(hash(code))}"
    (tmp_path / f"{name}.py").write_text(code)
    monkeypatch.syspath_prepend(str(tmp_path))
    with pytest.raises(InputError, match=said):
        estimator_of(f"{name}:Mine")


@pytest.mark.parametrize(
    ("methods", "said"),
    [
        ({"fitted_arrays": lambda _self: (FittedArray("nowhere_", (3,)),)}, "'nowhere_' is of shape"),
        (
            {"fitted_arrays": lambda _self: (FittedArray("mean_", (7,)),)},
            r"'fit' leaves float64 of shape \(3,\)",
        ),
        ({"fitted_arrays": lambda _self: None}, "its 'fitted_arrays' failed .TypeError"),
        ({"fitted_facts": ("nowhere_",)}, "'fit' does not set 'nowhere_', one of its 'fitted_facts'"),
        ({"stored_parameters": lambda _self: {"a": dict}}, "its parameter 'a' is .* cannot hold"),
        ({"stored_parameters": lambda _self: {"a": np.nan}}, "its parameter 'a' is nan, .* cannot hold"),
    ],
)
def test_what_a_file_cannot_hold_is_named_before_it_is_written(
    methods: dict[str, Any], said: str, stereo: View, volume: np.ndarray, tmp_path: Path
) -> None:
    X, path = stereo(volume), tmp_path / "m"
    estimator = own_with(**methods)().fit(X, volume)
    model = Model(estimator, ("left", "right"), ((640, 480),) * 2, TrainingBox.of(X, volume))
    with pytest.raises(InputError, match=said):
        save_model(path, model)
    assert not path.exists()


def test_names_of_methods_differ_in_more_than_capital_letters() -> None:
    with pytest.raises(InputError, match="'Affine' is a name of labcal's already, but for capital letters"):
        register_method(own_with(method="Affine"))
    register_method(own_with())
    with pytest.raises(InputError, match="'OWN' differs from 'own', which is registered"):
        register_method(own_with(method="OWN"))
    with pytest.raises(InputError, match=r"made without arguments, failed .TypeError"):
        register_method(own_with(method="needy", __init__=lambda self, a: None))  # noqa: ARG005 -- the form
    with pytest.raises(InputTypeError, match="subclass of PointEstimator"):
        register_method(Own())  # type: ignore[type-var]
