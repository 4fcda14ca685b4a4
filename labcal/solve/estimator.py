"""What all methods have in common: an estimator from pixels to points that checks what it is given."""

from abc import abstractmethod
from collections.abc import Iterator
from contextlib import contextmanager
from typing import Any, ClassVar, NamedTuple, TypeVar

import numpy as np
from jaxtyping import Float64
from numpy.typing import ArrayLike
from sklearn.base import BaseEstimator, RegressorMixin
from sklearn.utils.validation import check_is_fitted, validate_data

from labcal.errors import InputError, InputTypeError

Estimator = TypeVar("Estimator", bound="PointEstimator")


class FittedArray(NamedTuple):
    """A float64 array that a fitted estimator consists of: an attribute and its shape."""

    attribute: str
    shape: tuple[int, ...]


class PointEstimator(RegressorMixin, BaseEstimator):
    """A method that learns points from pixels; a scikit-learn regressor.

    X is (n, 2 x cameras) in px with columns x1 y1 x2 y2 ..., Y is (n, 3) in mm, and further outputs where an
    experiment asks. A method fills in `_fit` and `_predict` and says which arrays it consists of when fitted.

    Attributes
    ----------
    method : str
        The name under which the registry knows the method.
    fitted_facts : tuple of str
        Fitted attributes that are a number or a text, kept in a model file beside the arrays.
    """

    method: ClassVar[str]
    fitted_facts: ClassVar[tuple[str, ...]] = ()

    def fit(self: Estimator, X: ArrayLike, Y: ArrayLike) -> Estimator:  # noqa: PYI019 - the checker of tests rejects Self
        """Learn from pixels whose points are known.

        Parameters
        ----------
        X : array, (n, 2 x cameras)
            Pixels, px.
        Y : array, (n, outputs)
            Points, mm, and further outputs. One output may be given as (n,).

        Returns
        -------
        PointEstimator
            The estimator itself, fitted.

        Raises
        ------
        InputError
            Values that are missing, of the wrong shape, too few, or in a degenerate arrangement.
        InputTypeError
            Something that is no array of numbers.
        """
        pixels, points = self._training(X, Y)
        self.single_output_ = points.ndim == 1
        points = points.reshape(len(points), -1)
        self.n_outputs_ = points.shape[1]
        self._fit(pixels, points)
        return self

    def predict(self, X: ArrayLike) -> Float64[np.ndarray, "n *outputs"]:
        """Return the points that belong to pixels.

        Parameters
        ----------
        X : array, (n, 2 x cameras)
            Pixels, px, with the columns of the training.

        Returns
        -------
        float64 array
            (n, outputs), mm; (n,) when the training gave one output as (n,).

        Raises
        ------
        InputError
            Values that are missing, or another number of columns than in training.
        sklearn.exceptions.NotFittedError
            `fit` has not been called.
        """
        check_is_fitted(self, "n_outputs_")
        points = self._predict(self._inputs(X))
        return points[:, 0] if self.single_output_ else points

    @abstractmethod
    def fitted_arrays(self) -> tuple[FittedArray, ...]:
        """Return which arrays the fitted estimator consists of, for the present inputs and outputs."""

    @abstractmethod
    def _fit(self, pixels: Float64[np.ndarray, "n inputs"], points: Float64[np.ndarray, "n outputs"]) -> None:
        """Learn from checked arrays."""

    @abstractmethod
    def _predict(self, pixels: Float64[np.ndarray, "n inputs"]) -> Float64[np.ndarray, "n outputs"]:
        """Predict from checked pixels."""

    def _training(self, X: ArrayLike, Y: ArrayLike) -> tuple[np.ndarray, np.ndarray]:
        """Return both as finite float64 arrays of the same length."""
        with _own_errors(self.method):
            pixels, points = validate_data(
                self, X, Y, dtype=np.float64, multi_output=True, y_numeric=True, ensure_min_samples=2
            )
        return pixels, np.asarray(points, dtype=np.float64)

    def _inputs(self, X: ArrayLike) -> np.ndarray:
        """Return pixels to predict from as a finite float64 array of the trained width."""
        with _own_errors(self.method):
            return np.asarray(validate_data(self, X, reset=False, dtype=np.float64))

    def __sklearn_tags__(self) -> Any:  # noqa: ANN401 - scikit-learn is untyped
        """Tell scikit-learn that several outputs at once are expected."""
        tags = super().__sklearn_tags__()
        tags.target_tags.multi_output = True
        return tags


@contextmanager
def _own_errors(method: str) -> Iterator[None]:
    """Turn scikit-learn's refusals into this project's."""
    try:
        yield
    except TypeError as error:
        raise InputTypeError(f"{method}: {error}") from error
    except ValueError as error:
        message = str(error)
        if "NaN" in message or "infinity" in message:
            # Its advice to impute is wrong for measurements.
            first_line = message.partition("\n")[0]
            message = f"{first_line} Leave out the dots that not every camera has measured."
        raise InputError(f"{method}: {message}") from error
