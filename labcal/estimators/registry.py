"""Methods by name."""

from importlib import import_module
from typing import TYPE_CHECKING

from labcal.errors import UnknownNameError

if TYPE_CHECKING:
    from labcal.estimators.estimator import PointEstimator

# Where classes are, not classes: a method must not pay for the imports of another.
_CLASSES = {
    "affine": "affine:Affine",
    "bundle": "bundle:Bundle",
    "dlt": "dlt:Dlt",
    "homography": "homography:Homography",
    "hybrid": "hybrid:Hybrid",
    "mlp": "networks.mlp:Mlp",
    "mlp-bayes": "networks.mlp_bayes:MlpBayes",
    "quadratic": "quadratic:Quadratic",
    "ray-net": "networks.ray_net:RayNet",
    "two-plane": "two_plane:TwoPlane",
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
    module, _, class_name = _CLASSES[name].partition(":")
    found: type[PointEstimator] = getattr(import_module(f"labcal.estimators.{module}"), class_name)
    return found


def make_estimator(name: str) -> "PointEstimator":
    """Return a new estimator of a method, with its defaults; change them with ``set_params``.

    Raises
    ------
    UnknownNameError
        There is no such method; the nearest name is offered.
    """
    return method_class(name)()
