"""A method before it learns, with what a plan says of it."""

from collections.abc import Mapping

from labcal.bench.distortion.case import Setting
from labcal.errors import InputError, UnknownNameError
from labcal.estimators.estimator import PointEstimator
from labcal.estimators.method_choice import estimator_of
from labcal.wording import shown


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
        if not known:
            raise InputError(
                f"The method '{method}' has no settings, but '{name}' of it is given. Leave it out."
            )
        if name not in known:
            raise UnknownNameError(f"setting of {method}", name, known)
        _require_kind(method, name, value, known[name])
        estimator.set_params(**{name: value})
    return estimator


def _require_kind(method: str, name: str, value: Setting, usual: object) -> None:
    """Raise where a setting is of another kind than its default: a text for a number, say.

    Defaults that are nothing or a sequence say nothing about single values.

    Raises
    ------
    InputError
        A text, a number or a truth value is expected, and another of them is given.
    """
    for kind, words in _KINDS.items():
        if type(usual) is kind and type(value) not in _ALLOWED[kind]:
            raise InputError(
                f"The setting '{name}' of {method} is {words}, by default {shown(usual)}, but {shown(value)} "
                "is given."
            )


_KINDS = {bool: "true or false", int: "a whole number", float: "a number", str: "a text"}
_ALLOWED = {bool: (bool,), int: (int,), float: (int, float), str: (str,)}
