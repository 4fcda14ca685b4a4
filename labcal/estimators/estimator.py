"""The common base of all methods: an estimator from pixels to points that checks its input."""

from abc import abstractmethod
from collections.abc import Iterator
from contextlib import AbstractContextManager, contextmanager, nullcontext
from typing import Any, ClassVar, NamedTuple, TypeVar

import numpy as np
from jaxtyping import Float64
from numpy.typing import ArrayLike

from labcal.arrays import AnyArray, float_array
from labcal.bounds import MOST_MM
from labcal.errors import InputError, InputTypeError
from labcal.estimators.own_scale import own_scale
from labcal.estimators.predicted_numbers import real_numbers
from labcal.estimators.propagation import propagated_covariance
from labcal.estimators.scikit_learn import BaseEstimator, RegressorMixin, check_is_fitted, validate_data
from labcal.run.user_code import user_code

Estimator = TypeVar("Estimator", bound="PointEstimator")

CONFIDENCE = 0.95
"""Of the ellipsoids that are calibrated."""
COORDINATES = 3
"""X, Y and Z come first among the outputs."""


class FittedArray(NamedTuple):
    """A float64 array that a fitted estimator consists of: an attribute and its shape."""

    attribute: str
    shape: tuple[int, ...]


class PointEstimator(RegressorMixin, BaseEstimator):
    """A method that estimates points from pixels; a scikit-learn regressor.

    X is (n, 2 x cameras) in px with columns x1 y1 x2 y2 ..., Y is (n, 3) in mm, and further outputs where an
    experiment asks. A method fills in `_fit` and `_predict` and says which arrays it consists of when fitted.

    Attributes
    ----------
    fitted_facts : tuple of str
        Fitted attributes that are a number or a text, kept in a model file beside the arrays.
    residual_covariance_ : float64 array, (3, 3)
        Mean product of the errors of X, Y and Z on the training data, mm squared; smaller with fewer outputs.
    own_scale_ : float64 array, ()
        Factor of the covariance that the method itself causes, besides the noise of pixels; 1 unless
        `calibrate_covariance` was called.
    """

    own_scale_: Float64[np.ndarray, ""] = np.array(1.0)
    fitted_facts: ClassVar[tuple[str, ...]] = ()

    @property
    @abstractmethod
    def method(self) -> str:
        """The name, for messages and files; of labcal's own methods an attribute of the class."""

    def fit(self: Estimator, X: ArrayLike, Y: ArrayLike) -> Estimator:  # noqa: PYI019 - the checker of tests rejects Self
        """Fit to pixels and their known points.

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
        self.own_scale_ = np.array(1.0)
        with self._code_of("fit"):
            self._fit(pixels, points)
        self.residual_covariance_ = self._residual_covariance(pixels, points)
        return self

    def predict(self, X: ArrayLike) -> Float64[np.ndarray, "n *outputs"]:
        """Return the points of pixels.

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
        points = self._points(self._inputs(X))
        return points[:, 0] if self.single_output_ else points

    def predict_with_covariance(
        self, X: ArrayLike, pixel_covariance: AnyArray
    ) -> tuple[Float64[np.ndarray, "n outputs"], Float64[np.ndarray, "n dim dim"]]:
        """Return the points of pixels, and their covariances.

        Where a method knows no better, that is the pixels' noise propagated through its predictions, and the
        covariance of its errors on the training data, which stands for what it could not learn.

        Parameters
        ----------
        X : array, (n, 2 x cameras)
            As for `predict`.
        pixel_covariance : array_like, (n, cameras, 2, 2)
            Covariances of the pixels, px squared.

        Returns
        -------
        points : float64 array, (n, outputs)
            Mm.
        covariance : float64 array, (n, 3, 3)
            Of X, Y and Z, mm squared; smaller with fewer outputs.

        Raises
        ------
        InputError
            As for `predict`, or covariances of another shape than the pixels.
        sklearn.exceptions.NotFittedError
            `fit` has not been called.
        """
        check_is_fitted(self, "n_outputs_")
        pixels = self._inputs(X)
        pixel_covariance = float_array(pixel_covariance, (...,), "pixel_covariance")
        expected = (len(pixels), pixels.shape[1] // 2, 2, 2)
        if pixel_covariance.shape != expected or pixels.shape[1] % 2:
            raise InputError(
                f"{self.method}: covariances of shape {pixel_covariance.shape} were given for pixels of "
                f"shape {pixels.shape}, but need one of 2 x 2 for each point and camera."
            )
        with self._code_of("predict"):
            points, covariance = self._with_covariance(pixels, pixel_covariance)
        return self._require_points(points, len(pixels)), covariance

    def calibrate_covariance(
        self, X: ArrayLike, pixel_covariance: AnyArray, Y: Float64[np.ndarray, "n dim"]
    ) -> None:
        """Scale the covariance that the method itself causes by errors on points that it was not trained on.

        Afterwards 95% ellipsoids hold 95% of such errors; see :func:`~labcal.estimators.own_scale.own_scale`.

        Parameters
        ----------
        X, pixel_covariance
            As for `predict_with_covariance`.
        Y : float64 array, (n, 3)
            The true points, mm.
        """
        pixels, covariance = self._inputs(X), np.asarray(pixel_covariance, dtype=np.float64)
        with self._code_of("predict"):
            found = self._predict(pixels)
            noise, own = self._covariance_parts(pixels, covariance)
        self.own_scale_ = np.array(own_scale(found[:, :COORDINATES] - Y, noise, own, CONFIDENCE))

    def stored_arrays(self) -> tuple[FittedArray, ...]:
        """Return the arrays of the fitted estimator that are stored: its own and those of every method."""
        size = min(self.n_outputs_, COORDINATES)
        own = FittedArray("residual_covariance_", (size, size)), FittedArray("own_scale_", ())
        return (*self.fitted_arrays(), *own)

    def stored_parameters(self) -> dict[str, Any]:
        """Return the constructor arguments of the fitted estimator that are stored."""
        return dict(self.get_params())

    @abstractmethod
    def fitted_arrays(self) -> tuple[FittedArray, ...]:
        """Return the arrays that make up the fitted estimator, for the present inputs and outputs."""

    @abstractmethod
    def _fit(self, pixels: Float64[np.ndarray, "n inputs"], points: Float64[np.ndarray, "n outputs"]) -> None:
        """Fit to checked arrays."""

    @abstractmethod
    def _predict(self, pixels: Float64[np.ndarray, "n inputs"]) -> Float64[np.ndarray, "n outputs"]:
        """Predict from checked pixels."""

    def _residual_covariance(
        self, pixels: Float64[np.ndarray, "n inputs"], points: Float64[np.ndarray, "n outputs"]
    ) -> Float64[np.ndarray, "dim dim"]:
        """Return the mean product of the errors of X, Y and Z on the training data."""
        return self._mean_product(self._trained_points(pixels) - points)

    def _mean_product(self, errors: Float64[np.ndarray, "n outputs"]) -> Float64[np.ndarray, "dim dim"]:
        """Return the mean product of the errors of X, Y and Z."""
        errors = errors[:, :COORDINATES]
        with np.errstate(over="ignore", invalid="ignore"):  # of errors that are no lengths
            return np.asarray(errors.T @ errors / len(errors))

    def _points(self, pixels: Float64[np.ndarray, "n inputs"]) -> Float64[np.ndarray, "n outputs"]:
        """Return predictions, checked."""
        with self._code_of("predict"):
            found = self._predict(pixels)
        return self._require_points(found, len(pixels))

    def _trained_points(self, pixels: Float64[np.ndarray, "n inputs"]) -> Float64[np.ndarray, "n outputs"]:
        """Return predictions for the training data, which must be places."""
        found = self._points(pixels)
        if not (np.abs(found) <= MOST_MM).all():
            raise InputError(
                f"{self.method}: 'predict' gives points that are not finite, or beyond {MOST_MM:g} mm, for "
                "the pixels it was fitted to."
            )
        return found

    def _require_points(self, found: object, count: int) -> Float64[np.ndarray, "n outputs"]:
        """Return predictions, which must be an array of real numbers, a row for each point."""
        if not (isinstance(found, np.ndarray) and found.shape == (count, self.n_outputs_)):
            given = (
                f"an array of shape {found.shape}" if isinstance(found, np.ndarray) else type(found).__name__
            )
            raise InputError(
                f"{self.method}: 'predict' gave {given} for {count} pixels, but {self.n_outputs_} columns "
                f"were fitted: it should be {(count, self.n_outputs_)}."
            )
        return real_numbers(found, self.method)

    def _code_of(self, part: str) -> AbstractContextManager[None]:
        """Return the context in which a part of a method runs: errors of a user's class name it."""
        is_labcals = type(self).__module__.partition(".")[0] == __name__.partition(".")[0]
        return nullcontext() if is_labcals else user_code(f"{self.method}: its '{part}'")

    def _with_covariance(
        self,
        pixels: Float64[np.ndarray, "n inputs"],
        pixel_covariance: Float64[np.ndarray, "n cameras 2 2"],
    ) -> tuple[Float64[np.ndarray, "n outputs"], Float64[np.ndarray, "n dim dim"]]:
        """Return predictions and their covariances; methods may override it."""
        return self._predict(pixels), self._covariance(pixels, pixel_covariance)

    def _covariance(
        self,
        pixels: Float64[np.ndarray, "n inputs"],
        pixel_covariance: Float64[np.ndarray, "n cameras 2 2"],
    ) -> Float64[np.ndarray, "n dim dim"]:
        """Return the covariances of predictions."""
        noise, own = self._covariance_parts(pixels, pixel_covariance)
        return np.asarray(noise + self.own_scale_ * own)

    def _covariance_parts(
        self,
        pixels: Float64[np.ndarray, "n inputs"],
        pixel_covariance: Float64[np.ndarray, "n cameras 2 2"],
    ) -> tuple[Float64[np.ndarray, "n dim dim"], Float64[np.ndarray, "n dim dim"]]:
        """Return the covariances by pixels' noise, and by the method itself; methods may override it."""
        propagated = propagated_covariance(self._coordinates, pixels, pixel_covariance)
        return propagated, np.tile(self.residual_covariance_, (len(pixels), 1, 1))

    def _coordinates(self, pixels: Float64[np.ndarray, "n inputs"]) -> Float64[np.ndarray, "n dim"]:
        """Predict X, Y and Z only."""
        return self._predict(pixels)[:, :COORDINATES]

    def _training(self, X: ArrayLike, Y: ArrayLike) -> tuple[np.ndarray, np.ndarray]:
        """Return both as finite float64 arrays of the same length."""
        with _own_errors(self.method):
            pixels, points = validate_data(
                self,
                X,
                Y,
                dtype=np.float64,
                copy=True,
                multi_output=True,
                y_numeric=True,
                ensure_min_samples=2,
            )
        return pixels, np.array(points, dtype=np.float64)  # copies: a method may work in place

    def _inputs(self, X: ArrayLike) -> np.ndarray:
        """Return pixels as a finite float64 array of the width used in training."""
        with _own_errors(self.method):
            return np.asarray(validate_data(self, X, reset=False, dtype=np.float64))

    def __sklearn_tags__(self) -> Any:  # noqa: ANN401 - scikit-learn is untyped
        """Tell scikit-learn that several outputs at once are expected."""
        tags = super().__sklearn_tags__()
        tags.target_tags.multi_output = True
        return tags


@contextmanager
def _own_errors(method: str) -> Iterator[None]:
    """Convert errors of scikit-learn into those of labcal."""
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
