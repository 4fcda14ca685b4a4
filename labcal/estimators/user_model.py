"""Models of methods of one's own, from files: the reader names the method, and it is fitted again."""

from pathlib import Path

import numpy as np

from labcal.errors import InputError
from labcal.estimators.estimator import PointEstimator
from labcal.estimators.method_choice import estimator_of
from labcal.estimators.model_header import ModelHeader
from labcal.estimators.registry import make_estimator, method_names
from labcal.estimators.user_method import UserMethod
from labcal.run.user_code import SEPARATOR
from labcal.wording import clipped, shown

_ALIKE = 1e-6
"""Part of the trained volume's width by which a method that is fitted again may differ, from rounding."""


def estimator_to_fill(path: Path, header: ModelHeader, method: object | None) -> PointEstimator:
    """Return the estimator, not fitted, of a model's method.

    Parameters
    ----------
    path : Path
        The model, for messages.
    header : ModelHeader
        It names the method. What it names is not imported unless it is one of labcal's.
    method : str, type or object, optional
        The method of one's own that the reader names, as for
        :func:`~labcal.estimators.method_choice.estimator_of`.

    Raises
    ------
    UnknownNameError
        The method is not known here.
    InputError
        It is one of one's own and not named, or another one is named; or the class or a parameter is not the
        one of the file.
    """
    name = header.method
    if method is None:
        if SEPARATOR in name:
            raise InputError(
                f"The model {path} was fitted with '{clipped(name)}', which is none of labcal's methods, and "
                "code that a file names is never run by itself. If you know that method, name it: "
                f"`method='{clipped(name)}'` (in Python also a class or an estimator)."
            )
        return make_estimator(name)
    estimator = estimator_of(method)
    if isinstance(estimator, UserMethod):
        if SEPARATOR not in name:
            raise InputError(
                f"The model {path} was fitted with '{clipped(name)}', not with "
                f"'{clipped(estimator.method)}'. {_leave_out(name)}"
            )
        return _checked(path, header, estimator)
    if estimator.method != name:
        raise InputError(
            f"The model {path} was fitted with '{clipped(name)}', and '{clipped(str(method))}' is the method "
            f"'{clipped(estimator.method)}'. {_leave_out(name)}"
        )
    return estimator


def _leave_out(name: str) -> str:
    return "Name that one." if SEPARATOR in name or name not in method_names() else "Name no method."


def _checked(path: Path, header: ModelHeader, estimator: UserMethod) -> UserMethod:
    """Return the method with the model's name and seed; the regressor's parameters must be those of the file.

    They are compared and not taken over: one that names a file, or a folder with a cache, could make the
    regressor run what lies there.
    """
    found, given = header.facts.get("class_"), estimator.regressor_class
    if found != given:
        raise InputError(
            f"The model {path} was fitted with the class '{clipped(str(found))}', but the method that is "
            f"named is of the class '{clipped(given)}'. Name the one that it was fitted with."
        )
    seed = header.parameters.get("random_state")
    if type(seed) is not int or not 0 <= seed < 2**32:
        raise InputError(f"The model {path} has a 'random_state' that is no seed. Fit it again.")
    own = estimator.stored_parameters() | {"random_state": seed}
    for name in sorted(own.keys() & header.parameters.keys()):
        then, now = header.parameters[name], own[name]
        if then != now:
            raise InputError(
                f"The model {path} was fitted with {name.partition('__')[2]} = {shown(then)}, but the method "
                f"that is named has {shown(now)}. Give it the same parameters: an estimator in Python, or on "
                "the command line a function of yours that returns one."
            )
    estimator.set_params(name=header.method, random_state=seed)
    return estimator


def fit_as_stored(path: Path, estimator: UserMethod) -> None:
    """Fit a method of one's own to the training data that a file gave, and see that it is the same again.

    Raises
    ------
    InputError
        The method cannot be fitted, or gives other points than when the file was written.
    """
    stored, known = estimator.trained_predictions_, estimator.has_covariance_
    covariance = estimator.residual_covariance_ if known else None
    points = estimator.trained_points_
    estimator.refit(estimator.trained_pixels_, points, covariance)
    off = float(np.abs(estimator.trained_predictions_ - stored).max(initial=0.0))
    if off > _ALIKE * max(float(np.ptp(points, axis=0).max(initial=0.0)), 1.0):
        raise InputError(
            f"Fitted again to the data in the model {path}, '{clipped(estimator.method)}' gives points that "
            f"are up to {off:.3g} mm from those of before. It has been changed since, or something in it is "
            "random without a 'random_state'. Fit the model again."
        )
