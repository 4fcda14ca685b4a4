"""The kinds of targets by name, each with its description, its detector and its artwork."""

from collections.abc import Callable
from dataclasses import dataclass
from importlib import import_module
from typing import Any

from pydantic import BaseModel

from labcal.errors import InputError, InputTypeError, UnknownNameError
from labcal.run.names import is_name
from labcal.targets.charuco import CharucoBoard
from labcal.targets.grid import DotGrid
from labcal.targets.target import PrintableTarget, Target

PLAIN = "dots"
"""The kind of a description without the key `kind`."""

Part = Callable[..., Any] | str
"""A function, or where it is (``package.module:function``): imported when it is first used."""


@dataclass(frozen=True)
class TargetKind:
    """A kind of target.

    Attributes
    ----------
    name : str
        Value of the key `kind` of its descriptions.
    model : type
        The description: a pydantic model that is a :class:`~labcal.targets.target.PrintableTarget`.
    detector : callable or str
        Takes a grey picture (float64, shape (h, w)), the target and
        :class:`~labcal.detect.settings.DetectSettings`; returns :class:`~labcal.detect.dots.PictureDots`.
    outlines : callable or str
        Takes the target; returns all that is printed on it as one ``matplotlib.path.Path``, mm in the
        target's frame.
    """

    name: str
    model: type[BaseModel]
    detector: Part
    outlines: Part


_SHIPPED = (
    TargetKind(
        PLAIN, DotGrid, "labcal.detect.detector:detect_grid_dots", "labcal.targets.shapes:dot_outlines"
    ),
    TargetKind(
        "charuco",
        CharucoBoard,
        "labcal.detect.charuco:detect_charuco",
        "labcal.targets.shapes:charuco_outlines",
    ),
)
_KINDS: dict[str, TargetKind] = {kind.name: kind for kind in _SHIPPED}


def target_kinds() -> tuple[str, ...]:
    """Return the names of the kinds, labcal's first."""
    return tuple(_KINDS)


def kind_by_name(name: str) -> TargetKind:
    """Return a kind.

    Raises
    ------
    UnknownNameError
        There is none of that name; the nearest one that a description can name is offered.
    """
    if name not in _KINDS:
        raise UnknownNameError("kind of target", name, [kind for kind in _KINDS if kind != PLAIN])
    return _KINDS[name]


def kind_of(target: object) -> TargetKind:
    """Return the kind of a target, by its class.

    Raises
    ------
    InputTypeError
        It is of no registered kind.
    """
    for kind in _KINDS.values():
        if type(target) is kind.model:
            return kind
    raise InputTypeError(
        f"A target is a description of a registered kind ({', '.join(_KINDS)}), but {target!r:.80} is none. "
        "Register its kind with register_target."
    )


def function_of(part: Part) -> Callable[..., Any]:
    """Return a part of a kind as a function.

    Raises
    ------
    InputError
        There is no function at the place that a text names.
    """
    if not isinstance(part, str):
        return part
    module, _, name = part.partition(":")
    try:
        found: Callable[..., Any] = getattr(import_module(module), name)
    except (ImportError, AttributeError, ValueError) as error:
        raise InputError(
            f"'{part}' names no function: it should be package.module:function ({error})."
        ) from error
    return found


def register_target(kind: TargetKind) -> TargetKind:
    """Add a kind of one's own, whose descriptions are then read wherever those of labcal's kinds are.

    It is known in the process that registers it. Workers of a script import its module anew, so that what
    stands there outside ``if __name__ == "__main__":`` registers it in them, too.

    Parameters
    ----------
    kind : TargetKind
        One that was registered under the same name before is replaced, as when a cell of a notebook is run
        again.

    Raises
    ------
    InputTypeError
        Its model lacks something that a target has.
    InputError
        Its name is that of a kind of labcal, or no name; or its model has no key `kind`.
    """
    if not is_name(kind.name):
        raise InputError(f"A kind needs a name of letters, digits and hyphens, but has {kind.name!r:.80}.")
    if any(kind.name == shipped.name for shipped in _SHIPPED):
        raise InputError(f"'{kind.name}' is a kind of labcal's already. Give it another name.")
    fields = kind.model.model_fields
    parts = [name for one in (Target, PrintableTarget) for name in vars(one) if not name.startswith("_")]
    missing = [name for name in dict.fromkeys(parts) if not (name in fields or hasattr(kind.model, name))]
    if missing:
        raise InputTypeError(
            f"The model of '{kind.name}' is no target: it lacks {', '.join(sorted(missing))}."
        )
    if "kind" not in fields:
        raise InputError(
            f"Descriptions of '{kind.name}' are recognised by their key 'kind', which its model lacks: give "
            f"it kind: Literal['{kind.name}']."
        )
    _KINDS[kind.name] = kind
    return kind
