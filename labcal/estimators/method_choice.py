"""A method as a person gives it: by name, as ``package.module:Class``, or as an object."""

import inspect
import re
from importlib import import_module

from labcal.errors import InputError, UnknownNameError
from labcal.estimators.estimator import PointEstimator
from labcal.estimators.registry import SEPARATOR, make_estimator
from labcal.estimators.scikit_learn import clone
from labcal.estimators.user_method import UserMethod, class_path, is_regressor
from labcal.wording import clipped

_FORM = re.compile(r"[^\W\d]\w*(\.[^\W\d]\w*)*:[^\W\d]\w*(\.[^\W\d]\w*)*")


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
    return _estimator(_imported(method), method)


def _estimator(given: object, name: str | None) -> PointEstimator:
    """Return the estimator of a class, of an object, or of a function that makes one."""
    label = name or (
        f"{given.__module__}{SEPARATOR}{given.__qualname__}" if inspect.isclass(given) else class_path(given)
    )
    made = given
    if inspect.isclass(given) or (inspect.isroutine(given) and not is_regressor(given)):
        try:
            made = given()
        except Exception as error:  # whatever the user's own code raises
            raise InputError(
                f"The method '{clipped(label)}' cannot be made without arguments ({type(error).__name__}: "
                f"{error}). Name a function that returns it ready, or give it to 'labcal.pipeline.fit'."
            ) from error
    if isinstance(made, PointEstimator):
        copied: PointEstimator = clone(made)
        return copied
    if not is_regressor(made):
        raise InputError(
            f"'{clipped(label)}' is no method: it has no 'fit' and 'predict'. Name a class or a pipeline as "
            "those of scikit-learn, with fit(X, Y) and predict(X)."
        )
    return UserMethod(made, label)


def _imported(name: str) -> object:
    """Return what ``package.module:Class`` names."""
    if _FORM.fullmatch(name) is None:
        raise InputError(
            f"'{clipped(name)}' names no method of one's own. Its form is package.module:Class, as in "
            "sklearn.neighbors:KNeighborsRegressor."
        )
    module, _, path = name.partition(SEPARATOR)
    try:
        found: object = import_module(module)
    except ModuleNotFoundError as error:
        if error.name is not None and (module == error.name or module.startswith(f"{error.name}.")):
            raise InputError(
                f"There is no module '{clipped(error.name)}', which the method '{clipped(name)}' names. It "
                "is looked for among the installed packages and in the folder where the command is given."
            ) from error
        raise InputError(f"The module '{clipped(module)}' cannot be imported: {error}.") from error
    except Exception as error:  # whatever the user's own code raises
        raise InputError(
            f"The module '{clipped(module)}' cannot be imported ({type(error).__name__}: {error})."
        ) from error
    for part in path.split("."):
        if not hasattr(found, part):
            raise UnknownNameError(f"class in '{clipped(module)}'", part, _classes(found))
        found = getattr(found, part)
    return found


def _classes(module: object) -> list[str]:
    """Return the classes with fit and predict that a module has; all its names where there is none."""
    public = {name: value for name, value in vars(module).items() if not name.startswith("_")}
    classes = [
        name
        for name, value in public.items()
        if inspect.isclass(value) and hasattr(value, "fit") and hasattr(value, "predict")
    ]
    return classes or list(public)
