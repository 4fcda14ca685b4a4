"""Methods by name, and methods of one's own beside them."""

import inspect
from dataclasses import dataclass
from importlib import import_module
from typing import TYPE_CHECKING, Any

from labcal.errors import InputTypeError, UnknownNameError
from labcal.run.user_code import SEPARATOR, user_code

if TYPE_CHECKING:
    from labcal.estimators.estimator import PointEstimator


@dataclass(frozen=True)
class MethodEntry:
    """A method as lists show it.

    Attributes
    ----------
    where : str
        Module and class, which is imported when the method is used: none pays for the imports of another.
    summary : str
        What it is, for people.
    needs : str
        What it can learn from, for people.
    """

    where: str
    summary: str
    needs: str


_VOLUME = "two cameras or more; dots not all on one plane"
_ANY = "any number of cameras; dots on one plane or not"
# In the order in which they are recommended.
_METHODS = {
    "hybrid": MethodEntry(
        "labcal.estimators.hybrid:Hybrid",
        "bundle, and a smooth field of pixels for what the lens model leaves",
        f"{_VOLUME}, at most 4000",
    ),
    "bundle": MethodEntry(
        "labcal.estimators.bundle:Bundle", "each camera adjusted to the dots, with a lens model", _VOLUME
    ),
    "two-plane": MethodEntry(
        "labcal.estimators.two_plane:TwoPlane",
        "polynomials from a pixel to where its ray meets two planes",
        _VOLUME,
    ),
    "dlt": MethodEntry(
        "labcal.estimators.dlt:Dlt",
        "direct linear transform, without distortion",
        f"{_VOLUME}, 6 or more",
    ),
    "homography": MethodEntry(
        "labcal.estimators.homography:Homography",
        "a projective map of each camera to one plane",
        "any number of cameras; 4 dots or more on one plane of constant Z",
    ),
    "quadratic": MethodEntry(
        "labcal.estimators.quadratic:Quadratic",
        "regression on pixels and their products",
        f"{_ANY}, 15 or more of two cameras",
    ),
    "affine": MethodEntry(
        "labcal.estimators.affine:Affine", "linear regression on pixels", f"{_ANY}, 5 or more of two cameras"
    ),
    "mlp": MethodEntry(
        "labcal.estimators.networks.mlp:Mlp", "the paper's network, from all pixels to a point", _ANY
    ),
    "mlp-bayes": MethodEntry(
        "labcal.estimators.networks.mlp_bayes:MlpBayes", "mlp with weight decay that the data set", _ANY
    ),
    "ray-net": MethodEntry(
        "labcal.estimators.networks.ray_net:RayNet",
        "a network for each camera, from its pixels to rays",
        f"{_VOLUME}, 6 or more",
    ),
}
_PARTS = ("method", "fitted_arrays", "_fit", "_predict")
"""The attributes that a user's class must define."""
_REGISTERED: "dict[str, type[PointEstimator]]" = {}
"""Of programs that use labcal; those of this process only."""


def register_method(made: "type[PointEstimator]") -> "type[PointEstimator]":
    """Let a class be found by its own name, `method`; a class decorator.

    A model file that it wrote is then read like any other one. Methods are known in the process that
    registers them. A scikit-learn regressor needs no registration (:func:`labcal.pipeline.fit` takes it).

    Parameters
    ----------
    made : type
        A subclass of :class:`~labcal.estimators.estimator.PointEstimator`. One that was registered under the
        same name before is replaced, as when a cell of a notebook is run again.

    Raises
    ------
    InputTypeError
        It is no such class, or lacks methods that such a class has.
    InputError
        The name is that of a method of labcal, capital letters apart, or no name: letters, digits and
        hyphens; or the class cannot be made without arguments.
    """
    # Here, since scikit-learn and pydantic take a second, and help needs the names only.
    from labcal.estimators.estimator import PointEstimator  # noqa: PLC0415
    from labcal.run.registration import require_own_name  # noqa: PLC0415

    if not (isinstance(made, type) and issubclass(made, PointEstimator)):
        raise InputTypeError(
            f"A method that is registered is a subclass of PointEstimator, but {made!r:.80} is none. Give a "
            "scikit-learn regressor to 'fit' as it is."
        )
    require_whole(made)
    name: Any = getattr(made, "method", None)
    require_own_name("method", name, _METHODS, _REGISTERED)
    with user_code(f"The class {made.__name__}, made without arguments,"):
        made()
    _REGISTERED[name] = made
    return made


def require_whole(made: "type[PointEstimator]") -> None:
    """Raise where a class lacks what makes a method of it.

    Raises
    ------
    InputTypeError
        It leaves abstract members as they are.
    """
    missing = [name for name in _PARTS if getattr(getattr(made, name), "__isabstractmethod__", False)]
    if missing:
        raise InputTypeError(f"The class {made.__name__} is no whole method: it lacks {', '.join(missing)}.")


def method_names() -> list[str]:
    """Return the names of all methods, sorted."""
    return sorted(method_entries())


def method_entries() -> dict[str, MethodEntry]:
    """Return all methods by name, the one to begin with first."""
    return _METHODS | {name: _entry(made) for name, made in _REGISTERED.items()}


def _entry(made: "type[PointEstimator]") -> MethodEntry:
    summary = inspect.cleandoc(made.__doc__ or "").partition("\n")[0]
    return MethodEntry(f"{made.__module__}:{made.__qualname__}", summary, "registered by this program")


def method_class(name: str) -> "type[PointEstimator]":
    """Return the estimator class of a method.

    Raises
    ------
    UnknownNameError
        There is no such method; the nearest name is offered.
    """
    if name in _REGISTERED:
        return _REGISTERED[name]
    if name not in _METHODS:
        raise UnknownNameError("method", name, method_entries())
    module, _, class_name = _METHODS[name].where.partition(SEPARATOR)
    found: type[PointEstimator] = getattr(import_module(module), class_name)
    return found


def make_estimator(name: str) -> "PointEstimator":
    """Return a new estimator of a method, with its defaults; change them with ``set_params``.

    Raises
    ------
    UnknownNameError
        There is no such method; the nearest name is offered.
    """
    return method_class(name)()
