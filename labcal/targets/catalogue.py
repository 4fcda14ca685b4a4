"""Targets by name, or from a YAML file of one's own."""

from os import PathLike
from typing import Annotated, Any

from pydantic import PlainSerializer, PlainValidator

from labcal.errors import InputError, InputTypeError, UnknownNameError
from labcal.paths import AnyPath, as_text
from labcal.run.descriptions import description_content, description_names, validate_description
from labcal.targets.kalibr_target import from_kalibr, is_kalibr_target
from labcal.targets.registry import PLAIN, TargetKind, kind_by_name, target_kinds
from labcal.targets.target import PrintableTarget
from labcal.wording import shown

FOLDER = "calib_targets"


def _kind(content: dict[str, Any]) -> TargetKind:
    """Return which kind of target a description is of; grids of dots do not state it."""
    name = content.get("kind", PLAIN)
    if not isinstance(name, str) or (name == PLAIN and "kind" in content):
        named = ", ".join(kind for kind in target_kinds() if kind != PLAIN)
        raise InputError(f"kind: {name!r:.40} should be one of {named}, or left out for a grid of dots")
    return kind_by_name(name)


def _described(value: object) -> object:
    """Return the target of a description in a larger document."""
    if isinstance(value, PrintableTarget):
        return value
    if not isinstance(value, dict):
        raise ValueError("a target is a mapping of keys to values")  # noqa: TRY004 -- pydantic takes only this
    return _kind(value).model.model_validate(value)


def _by_its_own_model(target: PrintableTarget) -> object:
    return target


AnyTarget = PrintableTarget
"""A target of any registered kind."""
DescribedTarget = Annotated[PrintableTarget, PlainValidator(_described), PlainSerializer(_by_its_own_model)]
"""The same as it stands in a file: a grid of dots has no `kind`, all others have."""


def target_names() -> list[str]:
    """Return the names of the targets that labcal ships, sorted."""
    return description_names(FOLDER)


def target_of(given: AnyTarget | AnyPath) -> AnyTarget:
    """Return the target that is given, by itself, by name or by the path of a YAML file.

    Raises
    ------
    UnknownNameError, InputError
        As of :func:`load_target`.
    InputTypeError
        It is no target at all.
    """
    if isinstance(given, PrintableTarget):
        return given
    if isinstance(given, str | PathLike):
        return load_target(given)
    raise InputTypeError(
        f"A target is an object, a name or the path of a YAML file, but {shown(given)} of type "
        f"{type(given).__name__} was given."
    )


def load_target(name: AnyPath) -> AnyTarget:
    """Return the target of that name.

    Parameters
    ----------
    name : str or os.PathLike
        The name of a shipped target, or the path of a YAML file: labcal's, or the ``target.yaml`` of an
        AprilGrid of Kalibr's.

    Returns
    -------
    AnyTarget
        Its description: places of the dots, and sizes, in mm.

    Raises
    ------
    UnknownNameError
        No target has that name, and no file that path; the nearest name is offered. Or there is no such kind
        of target.
    InputError
        The description cannot be read, or a key or value in it is not allowed.

    Examples
    --------
    >>> from labcal import load_target
    >>> target = load_target("rings-10x8")
    >>> target.cols, target.rows, target.pitch_x_mm
    (10, 8, 3.5)
    >>> target.points()[[0, 1, 10]].tolist()  # mm; dots are numbered row by row from the lower left
    [[0.0, 0.0, 0.0], [3.5, 0.0, 0.0], [0.0, 3.5, 0.0]]
    """
    name = as_text(name)
    content = description_content("target", FOLDER, name)
    if is_kalibr_target(content):
        content = from_kalibr(content, name)
    try:
        kind = _kind(content)
    except UnknownNameError:
        raise
    except InputError as error:
        raise InputError(f"The target '{name}' cannot be used: {error}.") from error
    found = validate_description(kind.model, "target", name, content)
    if not isinstance(found, PrintableTarget):  # which registering has made sure of
        raise InputError(f"The kind '{kind.name}' describes no target.")
    return found


def described_grid(given: object, who: str, instead: str) -> object:
    """Return what a description names as its target, which must be a grid of dots, to be validated.

    Parameters
    ----------
    given : object
        The name of a target, or a description of one.
    who : str
        Who takes nothing else, with the verb, for messages.
    instead : str
        The name of a target that would do.

    Raises
    ------
    ValueError
        It is of another kind: for a validator, which says of what file.
    UnknownNameError, InputError
        As of :func:`load_target`.
    """
    target = load_target(given) if isinstance(given, str) else given
    kind = target.get("kind") if isinstance(target, dict) else getattr(target, "kind", None)
    if kind is not None:
        raise ValueError(
            f"{who} grids of dots only, and the target is of the kind '{kind}': name another one, such as "
            f"{instead}"
        )
    return target
