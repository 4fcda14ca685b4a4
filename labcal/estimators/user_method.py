"""A method of one's own: any regressor with fit and predict, made an estimator of points."""

import inspect
from functools import partial
from math import isfinite
from typing import Any

import numpy as np
from jaxtyping import Float64
from numpy.typing import ArrayLike

from labcal.bounds import MOST_WEIGHT
from labcal.estimators.estimator import COORDINATES, FittedArray, PointEstimator
from labcal.estimators.held_out_errors import Predict, held_out_errors
from labcal.estimators.predicted_numbers import real_numbers
from labcal.estimators.scikit_learn import clone
from labcal.run.threads import one_blas_thread
from labcal.run.user_code import user_code

Regressor = Any
"""An object with fit and predict, of whatever class a user has."""
_SEED = "random_state"


class UserMethod(PointEstimator):
    """A regressor with ``fit(X, Y)`` and ``predict(X)``, of scikit-learn or of one's own.

    A regressor that refuses several outputs, and says to scikit-learn that it takes one, is fitted once for
    each of X, Y and Z. A copy is fitted; the regressor that is given stays as it was.

    Covariances are those of errors on dots held out: the training data are split at random into five
    parts, and each is predicted by the method fitted to the others. They are the same for every point. They
    hold the pixels' noise as it was in training, and leave out what pixels that are noisier than that would
    add, and how much more the method may err where there are no trained dots near, between planes say. The
    expected error, which `labcal fit` tells, does try that. They are NaN where a part cannot be predicted.

    Parameters
    ----------
    regressor : object
        Not fitted, or fitted to something else, which does not matter.
    name : str
        What it is called: ``package.module:Class``.
    random_state : int
        Given to each ``random_state`` of the regressor, nested ones too, that is None.

    Attributes
    ----------
    regressor_ : object
        The fitted copy.
    class_ : str
        Module and name of the regressor's class.
    trained_pixels_, trained_points_, trained_predictions_ : float64 array
        What it was fitted to, px and mm, and what it made of it.
    n_trained_ : int
    has_covariance_ : bool
        Whether the errors on dots held out are known.
    """

    fitted_facts = ("class_", "n_trained_", "has_covariance_")

    def __init__(self, regressor: Regressor, name: str = "", random_state: int = 0) -> None:
        self.regressor = regressor
        self.name = name
        self.random_state = random_state

    @property
    def method(self) -> str:
        """The name, else the class of the regressor."""
        return self.name or self.regressor_class

    def fitted_arrays(self) -> tuple[FittedArray, ...]:
        """Return which arrays are kept: the training data, from which the regressor is fitted again."""
        n = self.n_trained_
        return (
            FittedArray("trained_pixels_", (n, self.n_features_in_)),
            FittedArray("trained_points_", (n, self.n_outputs_)),
            FittedArray("trained_predictions_", (n, self.n_outputs_)),
        )

    def stored_arrays(self) -> tuple[FittedArray, ...]:
        """Return which arrays are kept; no covariance where none is known."""
        return super().stored_arrays() if self.has_covariance_ else self.fitted_arrays()

    def stored_parameters(self) -> dict[str, Any]:
        """Return the seed, and the regressor's parameters that are numbers, texts or nothing.

        Others, a kernel say, have no form in a file.
        """
        own = {f"regressor__{name}": value for name, value in _parameters(self.regressor).items()}
        return {_SEED: self.random_state} | {name: value for name, value in own.items() if _is_plain(value)}

    @property
    def regressor_class(self) -> str:
        """Module and name of the regressor's class."""
        return class_path(self.regressor)

    def refit(
        self, X: ArrayLike, Y: ArrayLike, residual_covariance: Float64[np.ndarray, "dim dim"] | None
    ) -> "UserMethod":
        """Fit the regressor as `fit` does, where the errors on dots held out are known already.

        Parameters
        ----------
        X, Y : array, (n, 2 x cameras) and (n, outputs)
            Px and mm.
        residual_covariance : float64 array, (3, 3), optional
            Mm squared; None where the errors are not known.

        Raises
        ------
        InputError
            As of `fit`.
        """
        pixels, points = self._training(X, Y)
        self.single_output_, self.n_outputs_ = False, points.shape[1]
        self._fit(pixels, points)
        size = min(self.n_outputs_, COORDINATES)
        unknown = np.full((size, size), np.nan)
        self.has_covariance_ = residual_covariance is not None
        self.residual_covariance_ = unknown if residual_covariance is None else residual_covariance
        return self

    def _fit(self, pixels: Float64[np.ndarray, "n inputs"], points: Float64[np.ndarray, "n outputs"]) -> None:
        self.regressor_ = self._fitted(pixels, points)
        self.class_, self.n_trained_ = self.regressor_class, len(pixels)
        self.trained_pixels_, self.trained_points_ = pixels, points
        self.trained_predictions_ = self._trained_points(pixels)

    def _predict(self, pixels: Float64[np.ndarray, "n inputs"]) -> Float64[np.ndarray, "n outputs"]:
        return self._predicted(self.regressor_, pixels)

    def _residual_covariance(
        self, pixels: Float64[np.ndarray, "n inputs"], points: Float64[np.ndarray, "n outputs"]
    ) -> Float64[np.ndarray, "dim dim"]:
        """Return the mean product of errors on dots held out; NaN where there is a part that has none."""
        errors = held_out_errors(self._fitted_again, pixels, points)
        covariance = self._mean_product(errors)
        self.has_covariance_ = bool((np.abs(covariance) <= MOST_WEIGHT).all())
        return covariance if self.has_covariance_ else np.full_like(covariance, np.nan)

    def _fitted_again(self, pixels: np.ndarray, points: np.ndarray) -> Predict:
        """Return the predictions of a copy that is fitted to other points."""
        return partial(self._predicted, self._fitted(pixels, points))

    def _covariance_parts(
        self,
        pixels: Float64[np.ndarray, "n inputs"],
        pixel_covariance: Float64[np.ndarray, "n cameras 2 2"],  # noqa: ARG002 - of any noise
    ) -> tuple[Float64[np.ndarray, "n dim dim"], Float64[np.ndarray, "n dim dim"]]:
        """Return no noise, and the same covariance for every point: what pixels do to a tree has no slope."""
        own = np.tile(self.residual_covariance_, (len(pixels), 1, 1))
        return np.zeros_like(own), own

    def _fitted(
        self, pixels: Float64[np.ndarray, "n inputs"], points: Float64[np.ndarray, "n outputs"]
    ) -> Regressor:
        """Return a fitted copy of the regressor."""
        with one_blas_thread(), user_code(f"{self.method}: its 'fit'"):
            made = self._copy()
            try:
                made.fit(pixels.copy(), points.copy())  # it may work in place
            except ValueError:
                if not _takes_one_output(made):
                    raise
                from sklearn.multioutput import MultiOutputRegressor  # noqa: PLC0415 -- imports scipy.stats

                made = MultiOutputRegressor(self._copy())
                made.fit(pixels.copy(), points.copy())
            return made

    def _copy(self) -> Regressor:
        """Return the regressor, not fitted, with a seed for all that is random and has none."""
        made: Regressor = clone(self.regressor, safe=False)
        unset = [
            name
            for name, value in _parameters(made).items()
            if value is None and name.rpartition("__")[2] == _SEED
        ]
        if unset:
            made.set_params(**dict.fromkeys(unset, self.random_state))
        return made

    def _predicted(
        self,
        regressor: Regressor,
        pixels: Float64[np.ndarray, "n inputs"],
    ) -> Float64[np.ndarray, "n outputs"]:
        with one_blas_thread(), user_code(f"{self.method}: its 'predict'"):
            given = regressor.predict(pixels.copy())  # it may work in place
            masked = isinstance(given, np.ma.MaskedArray)
            found = np.array(given)
        found = real_numbers(found, self.method)
        if masked:
            found[np.ma.getmaskarray(given)] = np.nan
        if found.shape == (len(pixels),) and self.n_outputs_ == 1:
            found = found[:, None]
        return self._require_points(found, len(pixels))


def class_path(regressor: Regressor) -> str:
    """Return where the class of an object is: ``package.module:Class``."""
    return f"{type(regressor).__module__}:{type(regressor).__qualname__}"


def _parameters(regressor: Regressor) -> dict[str, Any]:
    """Return the parameters, nested ones too; nothing of a class that is not scikit-learn's kind."""
    known = getattr(regressor, "get_params", None)
    return dict(known(deep=True)) if callable(known) else {}


def _is_plain(value: object) -> bool:
    """Tell whether a model file can hold a parameter."""
    if isinstance(value, tuple):
        return all(type(part) is int for part in value)
    return value is None or isinstance(value, str | bool | int) or (type(value) is float and isfinite(value))


def _takes_one_output(regressor: Regressor) -> bool:
    """Tell whether a class says to scikit-learn that it is not made for several outputs."""
    tags = getattr(regressor, "__sklearn_tags__", None)
    return callable(tags) and not tags().target_tags.multi_output


def require_copies(method: str, regressor: Regressor) -> None:
    """Raise unless a regressor can be copied, since copies are fitted, and states its parameters.

    Raises
    ------
    InputError
        As of :func:`~labcal.run.user_code.user_code`.
    """
    with user_code(f"{method}: its 'get_params'"):
        _parameters(regressor)
    with user_code(f"{method}: a copy of it, which is what is fitted,"):
        clone(regressor, safe=False)


def is_regressor(given: object) -> bool:
    """Tell whether an object, which is no class, has fit and predict."""
    return not inspect.isclass(given) and all(
        callable(getattr(given, name, None)) for name in ("fit", "predict")
    )
