"""Targets by name, or from a YAML file of one's own."""

from collections.abc import Sequence
from os import PathLike
from pathlib import Path
from typing import Annotated, Any, cast

from pydantic import PlainSerializer, PlainValidator

from labcal.errors import InputError, InputTypeError, UnknownNameError
from labcal.paths import AnyPath, as_text
from labcal.run.descriptions import description_content, description_names, validate_description
from labcal.targets.kalibr_target import from_kalibr, is_kalibr_target
from labcal.targets.registry import BOARDS, PLAIN, TargetKind, kind_by_name, target_kinds
from labcal.targets.target import PrintableTarget
from labcal.wording import shown

FOLDER = "calib_targets"
BOARDS_KEY = "targets"
"""The key by which a description without a kind is one of several boards."""

AnyTarget = PrintableTarget
"""A target of any registered kind."""


def stated_kind(content: dict[str, Any]) -> TargetKind:
    """Return the kind of target of a description; grids of dots do not state it."""
    name = content.get("kind", BOARDS if BOARDS_KEY in content else PLAIN)
    if not isinstance(name, str) or (name == PLAIN and "kind" in content):
        named = ", ".join(kind for kind in target_kinds() if kind != PLAIN)
        raise InputError(f"kind: {name!r:.40} should be one of {named}, or left out for a grid of dots")
    return kind_by_name(name)


def _described(value: object) -> AnyTarget:
    """Return the target of a description in a larger document."""
    if isinstance(value, PrintableTarget):
        return value
    if not isinstance(value, dict):
        raise ValueError("a target is a mapping of keys to values")  # noqa: TRY004 -- pydantic takes only this
    return cast("AnyTarget", stated_kind(value).model.model_validate(value))


def described_target(value: object) -> AnyTarget:
    """Return a target that is given by itself, by name, by the path of its file, or by its description.

    Several in a list or a tuple are boards side by side, fixed to one plate.
    """
    if isinstance(value, list | tuple) and value:
        return _boards([described_target(one) for one in value])
    return load_target(value) if isinstance(value, str | PathLike) else _described(value)


def _by_its_own_model(target: PrintableTarget) -> object:
    return target


AnyTargets = PrintableTarget | AnyPath | Sequence[PrintableTarget | AnyPath]
"""A target by itself, by name or by path; several in a list are boards side by side."""
DescribedTarget = Annotated[PrintableTarget, PlainValidator(_described), PlainSerializer(_by_its_own_model)]
"""The same as it stands in a file: a grid of dots has no `kind`, all others have."""


def target_names() -> list[str]:
    """Return the names of the targets that labcal ships, sorted."""
    return description_names(FOLDER)


def target_of(given: AnyTargets) -> AnyTarget:
    """Return the target that is given, by itself, by name or by the path of a YAML file.

    Several in a list or a tuple are boards side by side, fixed to one plate.

    Raises
    ------
    UnknownNameError, InputError
        As of :func:`load_target`; or boards that are given together cannot be distinguished.
    InputTypeError
        It is no target at all.
    """
    if isinstance(given, PrintableTarget):
        return given
    if isinstance(given, str | PathLike):
        return load_target(given)
    if isinstance(given, list | tuple) and given:
        return _boards(given)
    raise InputTypeError(
        f"A target is an object, a name or the path of a YAML file, but {shown(given)} of type "
        f"{type(given).__name__} was given."
    )


def _boards(given: Sequence[AnyTarget | AnyPath]) -> AnyTarget:
    """Return boards on one plate, named after them; a single one as it is."""
    boards = [target_of(one) for one in given]
    if len(boards) == 1:
        return boards[0]
    name = "-".join(board.name for board in boards)
    content = {"kind": BOARDS, "name": name, "targets": tuple(boards)}
    return validated_target(kind_by_name(BOARDS), name, content)


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
    if isinstance(content.get(BOARDS_KEY), list):
        beside = [_beside(board, Path(name).parent) for board in content[BOARDS_KEY]]
        content = {"name": Path(name).stem, **content, BOARDS_KEY: beside}
    try:
        kind = stated_kind(content)
    except UnknownNameError:
        raise
    except InputError as error:
        raise InputError(f"The target '{name}' cannot be used: {error}.") from error
    return validated_target(kind, name, content)


def _beside(board: object, folder: Path) -> object:
    """Return the path of a board whose file lies beside the file that names it; else the board as given."""
    return str(folder / board) if isinstance(board, str) and (folder / board).is_file() else board


def validated_target(kind: TargetKind, name: str, content: dict[str, Any]) -> AnyTarget:
    """Return the target of a description of a kind.

    Raises
    ------
    InputError
        A key or value in it is not allowed.
    """
    found = validate_description(kind.model, "target", name, content)
    if not isinstance(found, PrintableTarget):  # which registering has made sure of
        raise InputError(f"The kind '{kind.name}' describes no target.")
    return found
