"""The fitted estimator that a model file describes, with everything in it checked against its method."""

from pathlib import Path
from typing import TYPE_CHECKING

import numpy as np

from labcal.bounds import MOST_WEIGHT
from labcal.errors import InputError, LabcalError
from labcal.estimators.model_header import ModelHeader, Value

if TYPE_CHECKING:
    from labcal.estimators.estimator import PointEstimator  # imports scikit-learn

_MOST_COUNT = 2**31
"""Of an integer that an estimator is constructed with."""


def stored_estimator(
    path: Path, header: ModelHeader, arrays: dict[str, np.ndarray], method: object | None
) -> "PointEstimator":
    """Return the fitted estimator of a model file; only attributes that its class declares are set.

    Parameters
    ----------
    path : Path
        For messages.
    header : ModelHeader
    arrays : dict of ndarray
        All arrays of the file, by name.
    method : str, type or object, optional
        The method of one's own that the reader names.

    Raises
    ------
    UnknownNameError
        The method is not known here.
    InputError
        The file holds what its method does not have, or the method is one of one's own and not named.
    """
    # Both import scikit-learn, which a reader of a header, or of a rig, does without.
    from labcal.estimators.user_method import UserMethod  # noqa: PLC0415 -- see above
    from labcal.estimators.user_model import estimator_to_fill, fit_as_stored  # noqa: PLC0415 -- see above

    estimator = estimator_to_fill(path, header, method)
    defaults = header.parameters if isinstance(estimator, UserMethod) else estimator.get_params()
    if header.parameters.keys() != defaults.keys() or header.facts.keys() != set(estimator.fitted_facts):
        raise InputError(
            f"The model {path} names parameters that the method '{header.method}' does not have."
        )
    if not isinstance(estimator, UserMethod):
        unknown = [name for name, value in header.parameters.items() if not _like(value, defaults[name])]
        if unknown:
            raise InputError(
                f"The model {path} has a '{unknown[0]}' that '{header.method}' does not take. Fit it again."
            )
        estimator.set_params(**header.parameters)
    estimator.n_features_in_ = header.inputs
    estimator.n_outputs_ = header.outputs
    estimator.single_output_ = False
    for name, value in header.facts.items():
        setattr(estimator, name, value)
    try:
        wanted = estimator.stored_arrays()
        if any(type(side) is not int for spec in wanted for side in spec.shape):
            raise TypeError  # noqa: TRY301 -- reported below, like errors of the method itself
    except LabcalError:
        raise
    except (TypeError, ValueError, LookupError, ArithmeticError) as error:
        raise InputError(
            f"The facts in the model {path} are none of '{header.method}'. Fit it again."
        ) from error
    for attribute, shape in wanted:
        setattr(estimator, attribute, checked_array(path, arrays, attribute, shape))
    if isinstance(estimator, UserMethod):
        fit_as_stored(path, estimator)
    return estimator


def _like(value: Value, default: object) -> bool:
    """Tell whether a parameter has the type of its default and is within bounds."""
    match default:
        case bool() | str():
            return type(value) is type(default)
        case int():
            return isinstance(value, int) and not isinstance(value, bool) and 0 <= value <= _MOST_COUNT
        case float():
            return (
                isinstance(value, int | float)
                and not isinstance(value, bool)
                and 0.0 <= float(value) <= MOST_WEIGHT
            )
        case _:  # widths of layers, picture sizes, or nothing
            counts = [] if value is None else np.ravel(np.array(value, dtype=object)).tolist()
            return all(type(count) is int and 1 <= count <= _MOST_COUNT for count in counts)


def checked_array(path: Path, arrays: dict[str, np.ndarray], name: str, shape: tuple[int, ...]) -> np.ndarray:
    """Return one array of a model file if it has the shape that its method needs.

    Raises
    ------
    InputError
        It is not there, is of another type or shape, or holds numbers that are not finite or beyond bounds.
    """
    array = arrays.get(name)
    if array is None or array.dtype != np.float64 or array.shape != shape or not np.isfinite(array).all():
        raise InputError(f"The model {path} lacks the array '{name}' as finite float64 of shape {shape}.")
    if np.abs(array).max(initial=0.0) > MOST_WEIGHT:
        raise InputError(f"The model {path} holds a number beyond {MOST_WEIGHT:g} in '{name}'. Fit it again.")
    return array
