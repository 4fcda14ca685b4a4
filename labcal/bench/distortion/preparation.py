"""A method before it learns, with what a plan says of it."""

from collections.abc import Mapping

from labcal.bench.distortion.case import Setting
from labcal.errors import UnknownNameError
from labcal.estimators.estimator import PointEstimator
from labcal.estimators.method_choice import estimator_of


def prepared_method(
    method: str,
    settings: Mapping[str, Setting],
    seed: int,
    image_sizes: tuple[tuple[int, int], ...],
) -> PointEstimator:
    """Return a new estimator with the settings of the plan, the pictures' sizes and the seed.

    Parameters
    ----------
    method : str
        A name, or ``package.module:Class``.
    settings : mapping
        Constructor arguments that differ from the defaults.
    seed : int
    image_sizes : tuple of (int, int)
        Width and height of each camera's pictures, px.

    Raises
    ------
    UnknownNameError, InputError
        There is no such method or setting, or it cannot be made.
    """
    estimator = estimator_of(method)
    known = estimator.get_params()
    given = {"image_sizes": image_sizes, "random_state": seed}
    estimator.set_params(**{name: value for name, value in given.items() if name in known})
    for name, value in settings.items():
        if name not in known:
            raise UnknownNameError(f"setting of {method}", name, known)
        estimator.set_params(**{name: value})
    return estimator
