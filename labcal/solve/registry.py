"""Methods by name."""

from importlib import import_module
from typing import TYPE_CHECKING

from labcal.errors import UnknownNameError

if TYPE_CHECKING:
    from labcal.solve.estimator import PointEstimator

# Class names, not classes: a method must not pay for the imports of another.
_CLASSES = {
    "affine": "Affine",
    "bundle": "Bundle",
    "dlt": "Dlt",
    "homography": "Homography",
    "hybrid": "Hybrid",
    "mlp": "Mlp",
    "mlp-bayes": "MlpBayes",
    "quadratic": "Quadratic",
    "ray-net": "RayNet",
    "two-plane": "TwoPlane",
}


def method_names() -> list[str]:
    """Return the names of all methods, sorted."""
    return sorted(_CLASSES)


def method_class(name: str) -> "type[PointEstimator]":
    """Return the estimator class of a method.

    Raises
    ------
    UnknownNameError
        There is no such method; the nearest name is offered.
    """
    if name not in _CLASSES:
        raise UnknownNameError("method", name, _CLASSES)
    module = import_module(f"labcal.solve.{name.replace('-', '_')}")
    found: type[PointEstimator] = getattr(module, _CLASSES[name])
    return found


def make_estimator(name: str) -> "PointEstimator":
    """Return a new estimator of a method, with its defaults; change them with ``set_params``.

    Raises
    ------
    UnknownNameError
        There is no such method; the nearest name is offered.
    """
    return method_class(name)()
