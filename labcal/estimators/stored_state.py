"""State of a fitted estimator, checked before it is written: a model file should be readable."""

from typing import TYPE_CHECKING, Any

import numpy as np
from pydantic import ConfigDict, TypeAdapter, ValidationError

from labcal.bounds import MOST_WEIGHT
from labcal.errors import InputError
from labcal.estimators.model_header import Value
from labcal.run.user_code import user_code

if TYPE_CHECKING:
    from labcal.estimators.estimator import PointEstimator  # imports scikit-learn

_VALUE: TypeAdapter[Value] = TypeAdapter(Value, config=ConfigDict(strict=True, allow_inf_nan=False))


def stored_arrays(estimator: "PointEstimator") -> dict[str, np.ndarray]:
    """Return the arrays of a fitted estimator, in one piece, in rows.

    Raises
    ------
    InputError
        `fitted_arrays` names an attribute that `fit` does not set, or one that is no finite float64 array of
        the shape that is stated; or it fails.
    """
    with user_code(f"{estimator.method}: its 'fitted_arrays'"):
        wanted = [(str(spec.attribute), tuple(spec.shape)) for spec in estimator.stored_arrays()]
    arrays = {}
    for name, shape in wanted:
        value = np.asarray(getattr(estimator, name, None))
        fits = value.dtype == np.float64 and value.shape == shape
        if not (fits and (np.abs(value) <= MOST_WEIGHT).all()):
            raise InputError(
                f"{estimator.method}: its 'fitted_arrays' states that '{name}' is of shape {shape}, but "
                f"'fit' leaves {value.dtype} of shape {value.shape} there. It should be finite float64, up "
                f"to {MOST_WEIGHT:g}."
            )
        arrays[name] = in_rows(value)
    return arrays


def stored_facts(estimator: "PointEstimator") -> dict[str, Any]:
    """Return the facts of a fitted estimator: numbers, texts, and tuples of them.

    Raises
    ------
    InputError
        `fit` does not set one of `fitted_facts`, or sets something that a file cannot hold.
    """
    missing = [name for name in estimator.fitted_facts if not hasattr(estimator, name)]
    if missing:
        raise InputError(f"{estimator.method}: 'fit' does not set '{missing[0]}', one of its 'fitted_facts'.")
    facts = {name: plain(getattr(estimator, name)) for name in estimator.fitted_facts}
    return _held(estimator, "fact", facts)


def stored_parameters(estimator: "PointEstimator") -> dict[str, Any]:
    """Return the constructor arguments of an estimator: numbers, texts, and tuples of them.

    Raises
    ------
    InputError
        One is something that a file cannot hold.
    """
    with user_code(f"{estimator.method}: its 'stored_parameters'"):
        values = {name: plain(value) for name, value in estimator.stored_parameters().items()}
    return _held(estimator, "parameter", values)


def _held(estimator: "PointEstimator", what: str, values: dict[str, Any]) -> dict[str, Any]:
    """Return named values, which a file must be able to hold."""
    for name, value in values.items():
        try:
            _VALUE.validate_python(value)
        except ValidationError as error:
            raise InputError(
                f"{estimator.method}: its {what} '{name}' is {value!r:.80}, which a model file cannot hold: "
                "it should be a finite number, a text, or a tuple of whole numbers."
            ) from error
    return values


def in_rows(value: np.ndarray) -> np.ndarray:
    """Return an array as it is written: float64, in one piece, in rows."""
    return np.ascontiguousarray(value, dtype=np.float64).reshape(np.shape(value))


def plain(value: Any) -> Any:  # noqa: ANN401 - scikit-learn is untyped
    """Return a parameter or fact without NumPy's scalar types, which JSON does not know."""
    if isinstance(value, np.generic):
        return value.item()
    return tuple(plain(element) for element in value) if isinstance(value, list | tuple) else value
