"""A method as a person gives it: by name, as ``package.module:Class``, or as an object."""

import inspect

from labcal.errors import InputError
from labcal.estimators.estimator import PointEstimator
from labcal.estimators.registry import make_estimator, require_whole
from labcal.estimators.scikit_learn import clone
from labcal.estimators.user_method import UserMethod, class_path, is_regressor, require_copies
from labcal.run.user_code import SEPARATOR, Place, imported, user_code
from labcal.wording import clipped


def _is_method(value: object) -> bool:
    return inspect.isclass(value) and hasattr(value, "fit") and hasattr(value, "predict")


_PLACE = Place(
    "method of one's own",
    "package.module:Class, as in sklearn.neighbors:KNeighborsRegressor",
    "class",
    _is_method,
)


def estimator_of(method: object) -> PointEstimator:
    """Return a new estimator of a method.

    Parameters
    ----------
    method : str, type or object
        The name of a method; ``package.module:Class``, which is imported; a class, which is made without
        arguments; or an estimator, which is copied. In a module there may also be an estimator that is made
        already, a pipeline say, or a function without arguments that returns one.

    Returns
    -------
    PointEstimator
        A `UserMethod` where the class is none of labcal's kind.

    Raises
    ------
    UnknownNameError
        There is no method, or no class, of that name; the nearest one is offered.
    InputError
        There is no such module, the class cannot be made, or it has no fit and predict.
    """
    if not isinstance(method, str):
        return _estimator(method, None)
    if SEPARATOR not in method:
        return make_estimator(method)
    return _estimator(imported(method, _PLACE), method)


def _estimator(given: object, name: str | None) -> PointEstimator:
    """Return the estimator of a class, of an object, or of a function that makes one."""
    label = name or (
        f"{given.__module__}{SEPARATOR}{given.__qualname__}" if inspect.isclass(given) else class_path(given)
    )
    made, what = given, f"The method '{clipped(label)}'"
    if inspect.isclass(given) or (inspect.isroutine(given) and not is_regressor(given)):
        mend = "Name a function that returns it ready, or give it to 'labcal.pipeline.fit'."
        with user_code(f"{what} cannot be made without arguments: it", mend):
            made = given()
    if isinstance(made, PointEstimator):
        require_whole(type(made))
        with user_code(f"{what}: a copy of it, which is what is fitted,"):
            copied: PointEstimator = clone(made)
        return copied
    with user_code(what):
        has_both = is_regressor(made)
    if not has_both:
        raise InputError(
            f"'{clipped(label)}' is no method: it has no 'fit' and 'predict'. Name a class or a pipeline as "
            "those of scikit-learn, with fit(X, Y) and predict(X)."
        )
    require_copies(what, made)
    return UserMethod(made, label)
