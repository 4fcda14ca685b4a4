"""The checks of annotations while testing, made once a call, and not at every call of a loop.

``pytest --jaxtyping-packages`` puts ``jaxtyping.jaxtyped`` on every function of labcal. That binds the
arguments of every call to the signature, and checks them twice, the second time with the result: two thirds
of the processor time of many tests. :func:`check_once` puts lighter checks of the same annotations in its
place, and has Python 3.11 collect the members of each protocol once.
"""

import dataclasses
import functools
import inspect
import sys
import typing
from collections.abc import Callable
from types import FunctionType, SimpleNamespace
from typing import Any

import jaxtyping
from beartype import BeartypeConf, beartype

_jaxtyped = jaxtyping.jaxtyped
_beartyped = beartype(conf=BeartypeConf(violation_type=jaxtyping.TypeCheckError))

FIRST, EVERY = 10, 20
"""Calls of a function that are checked in each test: so many first ones, and then every so many-th."""
_tests = [0]
"""The number of tests that have begun."""


def begin_test() -> None:
    """Let the first calls of each function be checked again."""
    _tests[0] += 1


def check_once() -> None:
    """Let jaxtyping's import hook put :func:`checked` on functions and classes from now on.

    Raises
    ------
    RuntimeError
        labcal has been imported already, so that its functions have the other checks or none.
    """
    if "labcal" in sys.modules:
        raise RuntimeError("labcal was imported before its annotations could be checked.")
    jaxtyping.jaxtyped = checked
    # Python 3.12 keeps the members of a protocol; a check by `Lens` takes 3 microseconds, else 200.
    if sys.version_info < (3, 12):
        typing._get_protocol_attrs = functools.cache(typing._get_protocol_attrs)


def checked(fn: Any = None, *, typechecker: Any = None) -> Any:
    """Return a function, or a dataclass, whose arguments and result are checked at every call.

    As with ``jaxtyping.jaxtyped``, lengths of one name are equal within a call, an annotation that cannot be
    resolved when the function is made is not checked, and ``jaxtyping_disable`` switches all checks off.
    """
    if fn is None:
        return functools.partial(checked, typechecker=typechecker)
    if inspect.isclass(fn):
        if dataclasses.is_dataclass(fn) and "__init__" in vars(fn):
            fn.__init__ = checked(fn.__init__)
        return fn
    if not isinstance(fn, FunctionType):
        return _jaxtyped(fn, typechecker=typechecker)
    return fn if getattr(fn, "__no_type_check__", False) else _checked_function(fn)


def _checked_function(fn: FunctionType) -> Callable[..., Any]:
    hints = {name: _resolved(hint, fn.__globals__) for name, hint in fn.__annotations__.items()}
    if not hints:
        return fn
    kept: list[Callable[..., Any]] = []
    config, calls, test = jaxtyping.config, 0, _tests[0]

    def is_checked() -> bool:
        """Count a call, and tell whether it is one of those that are checked."""
        nonlocal calls, test
        if test != _tests[0]:
            calls, test = 0, _tests[0]
        calls += 1
        return not ((calls > FIRST and calls % EVERY) or config.jaxtyping_disable)

    def typed() -> Callable[..., Any]:
        """Return the function with its checks, made at its first call: a process calls few."""
        if not kept:
            kept.append(_typed(fn, hints))
        return kept[0]

    @functools.wraps(fn)
    def without_arrays(*args: Any, **kwargs: Any) -> Any:
        return typed()(*args, **kwargs) if is_checked() else fn(*args, **kwargs)

    @functools.wraps(fn)
    def with_arrays(*args: Any, **kwargs: Any) -> Any:
        if not is_checked():
            return fn(*args, **kwargs)
        with _jaxtyped("context"):  # lengths of this call alone
            return typed()(*args, **kwargs)

    return with_arrays if any(map(_names_arrays, hints.values())) else without_arrays


def _typed(fn: FunctionType, hints: dict[str, Any]) -> Callable[..., Any]:
    """Return a function whose arguments and result beartype checks."""
    annotated = FunctionType(fn.__code__, fn.__globals__, fn.__name__, fn.__defaults__, fn.__closure__)
    functools.update_wrapper(annotated, fn)
    del annotated.__wrapped__  # beartype would read the annotations of that
    annotated.__kwdefaults__, annotated.__annotations__ = fn.__kwdefaults__, hints
    return _beartyped(annotated)


def _resolved(hint: Any, names: dict[str, Any]) -> Any:
    """Return an annotation without strings; `Any` where one of its names is not known yet."""
    try:
        return typing.get_type_hints(
            SimpleNamespace(__annotations__={"hint": hint}), names, include_extras=True
        )["hint"]
    except (AttributeError, NameError, TypeError):
        return Any


def _names_arrays(hint: Any) -> bool:
    """Tell whether shapes of arrays stand anywhere in an annotation."""
    return (inspect.isclass(hint) and issubclass(hint, jaxtyping.AbstractArray)) or any(
        _names_arrays(part)
        for part in (*typing.get_args(hint), *(typing.get_args(getattr(hint, "__value__", None))))
    )
