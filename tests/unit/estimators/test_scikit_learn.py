"""The methods are scikit-learn estimators: its own checks, and its tools on stereo data."""

from collections.abc import Callable, Iterator

import jaxtyping
import numpy as np
import pytest
from sklearn.base import clone
from sklearn.model_selection import KFold, cross_val_score
from sklearn.pipeline import make_pipeline
from sklearn.preprocessing import StandardScaler
from sklearn.utils.estimator_checks import parametrize_with_checks

from labcal.estimators.affine import Affine
from labcal.estimators.estimator import PointEstimator
from labcal.estimators.networks.mlp import Mlp
from labcal.estimators.networks.mlp_bayes import MlpBayes
from labcal.estimators.quadratic import Quadratic
from labcal.estimators.registry import make_estimator, method_names

View = Callable[[np.ndarray], np.ndarray]


FEWER_THAN_UNKNOWNS = "gives fewer points than the terms of second degree, which is refused by design"
EXPECTED_FAILURES = {
    "affine": {},
    "quadratic": {
        "check_estimators_dtypes": FEWER_THAN_UNKNOWNS,
        "check_dtype_object": FEWER_THAN_UNKNOWNS,
        "check_regressor_multioutput": FEWER_THAN_UNKNOWNS,
        "check_regressors_no_decision_function": FEWER_THAN_UNKNOWNS,
        "check_regressors_int": FEWER_THAN_UNKNOWNS,
    },
    "mlp": {},
    "mlp-bayes": {},
}
"""By method, the checks that must fail and why; no others do."""


def expected_failures(estimator: PointEstimator) -> dict[str, str]:
    return EXPECTED_FAILURES[estimator.method]


@pytest.fixture
def unchecked_types() -> Iterator[None]:
    """Let through what the tests' checker of annotations would refuse before the estimator can."""
    jaxtyping.config.update("jaxtyping_disable", True)
    yield
    jaxtyping.config.update("jaxtyping_disable", False)


@parametrize_with_checks(
    [Affine(), Quadratic(), Mlp(hidden=(5,), max_epochs=20), MlpBayes(hidden=(5,), max_epochs=20)],
    expected_failed_checks=expected_failures,
)
@pytest.mark.usefixtures("unchecked_types")
def test_scikit_learns_own_checks(estimator: PointEstimator, check: Callable[[PointEstimator], None]) -> None:
    check(estimator)


def quick(name: str) -> PointEstimator:
    """Return an estimator of a method that is fitted in a moment."""
    estimator = make_estimator(name)
    known, wanted = estimator.get_params(), {"hidden": (5,), "max_epochs": 15, "lens": "pinhole"}
    return estimator.set_params(**{key: value for key, value in wanted.items() if key in known})


def trained_on(name: str, plane: np.ndarray, volume: np.ndarray) -> np.ndarray:
    """Return the points that a method can learn from: `homography` knows planes only."""
    return plane if name == "homography" else volume


@pytest.mark.parametrize("name", method_names())
def test_clones_are_unfitted_and_learn_the_same(
    name: str, stereo: View, plane: np.ndarray, volume: np.ndarray
) -> None:
    Y = trained_on(name, plane, volume)
    X = stereo(Y)
    first = quick(name).fit(X, Y)
    copy = clone(first)
    assert copy.get_params() == first.get_params()
    assert not [key for key in vars(copy) if key.endswith("_")]
    assert copy.fit(X, Y).predict(X).tobytes() == first.predict(X).tobytes()


@pytest.mark.parametrize("name", method_names())
def test_pipelines_predict_what_the_method_does(
    name: str, stereo: View, plane: np.ndarray, volume: np.ndarray
) -> None:
    Y = trained_on(name, plane, volume)
    X = stereo(Y)
    alone = quick(name).fit(X, Y).predict(X)
    np.testing.assert_array_equal(make_pipeline("passthrough", quick(name)).fit(X, Y).predict(X), alone)


@pytest.mark.parametrize("name", ["affine", "quadratic", "mlp", "mlp-bayes"])
def test_regressions_do_not_mind_the_scale_of_pixels(name: str, stereo: View, volume: np.ndarray) -> None:
    X = stereo(volume)
    scaled = make_pipeline(StandardScaler(), quick(name)).fit(X, volume).predict(X)
    np.testing.assert_allclose(scaled, quick(name).fit(X, volume).predict(X), atol=1e-3)


@pytest.mark.parametrize("name", method_names())
def test_cross_validation_on_stereo_data(
    name: str, stereo: View, plane: np.ndarray, volume: np.ndarray
) -> None:
    Y = trained_on(name, plane, volume)
    folds = KFold(3, shuffle=True, random_state=0)
    # The score of R squared is 1 at best; a plane's Z does not vary, where it counts as 1 if exact.
    scores = cross_val_score(quick(name), stereo(Y), Y, cv=folds, scoring="r2")
    assert scores.shape == (3,)
    assert (scores > 0.9).all()
