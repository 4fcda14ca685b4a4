"""The kinds of targets by name, each with its description, its detector and its artwork."""

from collections.abc import Callable
from dataclasses import dataclass
from inspect import signature
from typing import Any

from pydantic import BaseModel, ValidationError

from labcal.errors import InputError, InputTypeError, UnknownNameError
from labcal.run.registration import require_members, require_own_name
from labcal.run.user_code import Place, imported, user_code
from labcal.targets.april_grid import AprilGrid
from labcal.targets.board_set import BoardSet
from labcal.targets.charuco import CharucoBoard
from labcal.targets.chessboard import Chessboard
from labcal.targets.coded_dots import CodedDots
from labcal.targets.grid import DotGrid
from labcal.targets.target import PrintableTarget, Target

PLAIN = "dots"
"""The kind of a description without the key `kind`."""

BOARDS = "boards"
"""The kind of a description with a list of targets."""

Part = Callable[..., Any] | str
"""A function, or where it is (``package.module:function``): imported when it is first used."""
_PLACE = Place("function", "package.module:function", "function", callable)
_PARTS = {"detector": ("grey", "target", "settings"), "outlines": ("target",)}
"""The parts of a kind that are functions, with their arguments."""


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
        Takes a grey picture (float32, shape (h, w)), the target and
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
    TargetKind(
        "coded-dots",
        CodedDots,
        "labcal.detect.marks.coded_sheet:detect_coded_sheet",
        "labcal.targets.coded_dot_outlines:coded_dot_outlines",
    ),
    TargetKind(
        "chessboard",
        Chessboard,
        "labcal.detect.chessboard:detect_chessboard",
        "labcal.targets.chessboard_outlines:chessboard_outlines",
    ),
    TargetKind(
        "aprilgrid",
        AprilGrid,
        "labcal.detect.april_grid:detect_april_grid",
        "labcal.targets.april_grid_outlines:april_grid_outlines",
    ),
    TargetKind(
        BOARDS,
        BoardSet,
        "labcal.detect.boards:detect_boards",
        "labcal.targets.board_set_outlines:board_set_outlines",
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


def run_part(kind: TargetKind, name: str, *given: object) -> Any:  # noqa: ANN401 -- of any kind
    """Return what a part of a kind, its detector or its outlines, makes of the arguments.

    Raises
    ------
    UnknownNameError, InputError
        There is no function at the place that a text names; or it is a user's, and fails.
    """
    part: Part = getattr(kind, name)
    function = imported(part, _PLACE) if isinstance(part, str) else part
    what = f"The kind of target '{kind.name}': its '{name}'"
    if not callable(function):
        raise InputError(f"{what} should be a function, or where one is, but is {part!r:.80}.")
    if kind in _SHIPPED:
        return function(*given)
    with user_code(what):
        return function(*given)


def is_shipped(kind: TargetKind) -> bool:
    """Tell whether a kind is one of labcal's own."""
    return kind in _SHIPPED


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
        It is no kind; its model is no class of pydantic's, or lacks something that a target has.
    InputError
        Its name is that of a kind of labcal, capital letters apart, or no name; its model has no key `kind`
        with this name, or is that of another kind; or a part is no function of so many arguments.
    """
    if not isinstance(kind, TargetKind):
        raise InputTypeError(f"What is registered should be a TargetKind, not {type(kind).__name__}.")
    own = _KINDS.keys() - {shipped.name for shipped in _SHIPPED}
    require_own_name("kind of target", kind.name, [shipped.name for shipped in _SHIPPED], own)
    _require_model(kind)
    for name, form in _PARTS.items():
        _require_part(kind, name, form)
    _KINDS[kind.name] = kind
    return kind


def _require_model(kind: TargetKind) -> None:
    """Raise unless the model of a kind describes targets, and those of this kind alone."""
    if not (isinstance(kind.model, type) and issubclass(kind.model, BaseModel)):
        raise InputTypeError(
            f"The model of '{kind.name}' should be a class of pydantic's BaseModel, not {kind.model!r:.80}."
        )
    fields = kind.model.model_fields
    require_members(f"The model of '{kind.name}' is no target", kind.model, (Target, PrintableTarget), fields)
    if "kind" not in fields:
        raise InputError(
            f"Descriptions of '{kind.name}' are recognised by their key 'kind', which its model lacks: give "
            f"it kind: Literal['{kind.name}']."
        )
    if not _accepts_its_name(kind):
        raise InputError(
            f"Descriptions of '{kind.name}' state this name under their key 'kind', which its model refuses: "
            f"give it kind: Literal['{kind.name}']."
        )
    for other in _KINDS.values():
        if other.model is kind.model and other.name != kind.name:
            raise InputError(
                f"The model {kind.model.__name__} of '{kind.name}' is that of the kind '{other.name}', from "
                "which it could not be told apart. Give it a class of its own."
            )


def _accepts_its_name(kind: TargetKind) -> bool:
    """Tell whether the name of a kind is a value of its model's key `kind`."""
    with user_code(f"The model of '{kind.name}'"):
        try:
            kind.model.model_validate({"kind": kind.name})
        except ValidationError as error:
            return not any(fault["loc"][:1] == ("kind",) for fault in error.errors())
    return True


def _require_part(kind: TargetKind, name: str, form: tuple[str, ...]) -> None:
    """Raise where a part is seen to be no function of its arguments; a text is looked up when it is used."""
    part = getattr(kind, name)
    if isinstance(part, str):
        return
    wanted = f"should be a function of ({', '.join(form)})"
    if not callable(part):
        raise InputError(f"The kind of target '{kind.name}': its '{name}' {wanted}, but is {part!r:.80}.")
    try:
        signature(part).bind(*form)
    except ValueError:  # one without a signature, as of compiled code
        return
    except TypeError as error:
        raise InputError(f"The kind of target '{kind.name}': its '{name}' {wanted} ({error}).") from error
