"""What is given to ``fit`` stays as it was, whoever wrote it: a copy learns."""

from collections.abc import Callable
from copy import deepcopy
from dataclasses import dataclass, field
from typing import Any

import numpy as np
import pytest
from sklearn.linear_model import LinearRegression, Ridge
from sklearn.pipeline import make_pipeline
from sklearn.preprocessing import PolynomialFeatures, StandardScaler

from labcal import examples, load_target, pipeline
from labcal.estimators.affine import Affine
from labcal.estimators.bundle import Bundle
from labcal.estimators.dlt import Dlt
from labcal.estimators.model import Model
from labcal.estimators.quadratic import Quadratic
from labcal.estimators.training import Training
from labcal.public_object import same_value

QUICK = pipeline.FitSettings("brown-k1k2", rehearsal=False)


@dataclass
class Remembering:
    """Nearest neighbour that keeps what it learns in a list that it was given, and in new attributes."""

    seen: list[Any] = field(default_factory=list)

    def fit(self, X: np.ndarray, Y: np.ndarray) -> "Remembering":
        self.seen.append((X, Y))
        self.learned_ = X.copy()
        return self

    def predict(self, X: np.ndarray) -> np.ndarray:
        known, points = self.seen[-1]
        return np.asarray(points[((X[:, None] - known) ** 2).sum(axis=2).argmin(axis=1)])


def already_fitted() -> LinearRegression:
    """Return one with attributes of data of its own."""
    rng = np.random.default_rng(0)
    return LinearRegression().fit(rng.normal(size=(9, 2)), rng.normal(size=9))


def state(given: Any) -> Any:  # noqa: ANN401 -- of any estimator
    """Return parameters and attributes, those of the steps of a pipeline too."""
    held = deepcopy(vars(given))
    return held | {"steps": [(name, vars(step)) for name, step in held.get("steps", [])]}


@pytest.fixture(scope="module")
def training() -> Training:
    return pipeline.training_of(load_target(examples.TARGET), examples.detections(), QUICK)


@pytest.mark.parametrize(
    "make",
    [
        Affine,
        Quadratic,
        Dlt,
        lambda: Bundle("brown-k1k2"),
        lambda: Ridge(1e-6),
        already_fitted,
        lambda: make_pipeline(StandardScaler(), PolynomialFeatures(2), Ridge(1e-6)),
        Remembering,
    ],
)
def test_an_estimator_stays_as_it_was(make: Callable[[], Any], training: Training) -> None:
    given = make()
    before = state(given)
    model = learned(training, given)
    assert same_value(state(given), before)
    assert model.estimator is not given


@pytest.mark.parametrize("made", [Affine, LinearRegression, Remembering])
def test_a_class_stays_as_it_was(made: type, training: Training) -> None:
    before = dict(vars(made))
    learned(training, made)
    assert vars(made).keys() == before.keys()
    assert all(vars(made)[name] is held for name, held in before.items())


def learned(training: Training, given: object) -> Model:
    """Return the model that :func:`labcal.pipeline.fit` makes of what it is given."""
    (model,) = pipeline.fit_methods(training, pipeline.estimators_of([given], QUICK), QUICK)
    assert isinstance(model, Model)
    return model
