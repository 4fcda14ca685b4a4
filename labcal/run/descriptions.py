"""Descriptions in YAML, found by name among those that ship with labcal or by the path of a file."""

import re
from difflib import get_close_matches
from importlib.resources import files
from importlib.resources.abc import Traversable
from pathlib import Path
from typing import Any, TypeVar

from pydantic import BaseModel, ValidationError
from pydantic_core import ErrorDetails

from labcal.errors import InputError, UnknownNameError
from labcal.run.file_reading import MOST_OF_A_DESCRIPTION, read_text
from labcal.run.known_keys import keys_at
from labcal.run.yaml_reading import yaml_content
from labcal.wording import clipped, shown

Description = TypeVar("Description", bound=BaseModel)


def _shipped(folder: str) -> Traversable:
    """Return the folder inside the wheel, or at the top of a source tree."""
    package = files("labcal")
    inside = package / "data" / folder
    return inside if inside.is_dir() else package / ".." / folder


def description_names(folder: str) -> list[str]:
    """Return the names of the shipped descriptions in `folder`, sorted."""
    return sorted(
        entry.name.removesuffix(".yaml")
        for entry in _shipped(folder).iterdir()
        if entry.name.endswith(".yaml")
    )


def explain_validation(error: ValidationError, model: type[BaseModel] | None = None) -> str:
    """Return the faults that pydantic found, with the path of each key.

    Where `model` is given, the nearest key that it has at that place is offered for an unknown one.
    """
    faults = error.errors(include_url=False)
    lines: list[str] = []
    for fault in faults[: 4 * _MOST_FAULTS]:
        within = [other for other in faults if other["loc"][: len(fault["loc"])] == fault["loc"]]
        if fault["type"] == "too_short" and len(within) > 1:
            continue  # it only counts what those within it left over
        where = clipped(".".join(clipped(str(part), 40) for part in fault["loc"]), 120) or "the whole"
        lines.append(f"{where}: {_plainly(fault, model)}")
    shown_faults = "; ".join(lines[:_MOST_FAULTS])
    more = len(faults) - min(len(lines), _MOST_FAULTS)
    return shown_faults if len(faults) <= _MOST_FAULTS else f"{shown_faults}; and {more} more"


_MOST_FAULTS = 8
"""Number of faults that are reported of one file."""


def _plainly(fault: ErrorDetails, model: type[BaseModel] | None) -> str:
    """Return the fault at one key, and its remedy."""
    context, given = fault.get("ctx", {}), fault["input"]
    match fault["type"]:
        case "extra_forbidden":
            return "this key is not known; " + _mend(fault["loc"], model)
        case "missing":
            return "this key is missing"
        case "literal_error" | "enum":
            return _not_among(given, str(context["expected"]))
        case "union_tag_invalid":
            return _not_among(context["tag"], str(context["expected_tags"]))
    if expected := _expected(fault):
        return f"{shown(given)} should be {expected}"
    return clipped(fault["msg"].removeprefix("Value error, "), 400).rstrip(".")


def _expected(fault: ErrorDetails) -> str:
    """Return the kind or the bound of a value that a fault is about; an empty text where there is none."""
    if bound := _BOUNDS.get(fault["type"]):
        return f"{bound} {next(iter(fault.get('ctx', {}).values()))}"
    return _KINDS.get(fault["type"], "")


_LIST, _MAPPING = "a list, in brackets: [..., ...]", "a mapping of keys to values"
_KINDS = {
    "tuple_type": _LIST,
    "list_type": _LIST,
    "dict_type": _MAPPING,
    "mapping_type": _MAPPING,
    "model_type": _MAPPING,
}
_BOUNDS = {
    "greater_than": "more than",
    "greater_than_equal": "at least",
    "less_than": "less than",
    "less_than_equal": "at most",
}


def _not_among(given: object, expected: str) -> str:
    """Return the message for a word that is not expected, with the nearest one that is."""
    short = clipped(given) if isinstance(given, str) else shown(given)
    nearest = get_close_matches(short, re.findall(r"'([^']*)'", expected), n=1, cutoff=0.5)
    mend = f" (did you mean '{nearest[0]}'?)" if nearest else ""
    return f"'{short}' is none of {expected}{mend}"


def _mend(place: tuple[int | str, ...], model: type[BaseModel] | None) -> str:
    """Return the advice for an unknown key."""
    known = [] if model is None else keys_at(model, place[:-1])
    if place[-1] in known:
        return "another kind has it, this one does not, so remove it"
    nearest = get_close_matches(clipped(str(place[-1])), known, n=1, cutoff=0.6)
    return f"the nearest one is '{nearest[0]}'" if nearest else "remove it or check its spelling"


def parse_yaml(text: str, source: str) -> dict[str, Any]:
    """Return the mapping in a YAML text.

    Raises
    ------
    InputError
        The text is not YAML, or not a mapping.
    """
    content = yaml_content(text, source)
    if not isinstance(content, dict):
        raise InputError(
            f"{source} should hold a mapping of keys to values, but holds {type(content).__name__}."
        )
    return content


def description_content(kind: str, folder: str, name: str) -> dict[str, Any]:
    """Return the raw mapping of a shipped description, or of the YAML file at a path.

    Raises
    ------
    UnknownNameError
        `name` is neither shipped nor the path of a file.
    InputError
        The file cannot be read or is no mapping.
    """
    if name in description_names(folder):
        return parse_yaml((_shipped(folder) / f"{name}.yaml").read_text(encoding="utf-8"), f"{kind} '{name}'")
    path = Path(name)
    if path.suffix in {".yaml", ".yml"} or path.is_file():
        return parse_yaml(read_text(path, f"{kind} file", MOST_OF_A_DESCRIPTION), str(path))
    raise UnknownNameError(kind, name, description_names(folder))


def validate_description(
    model: type[Description], kind: str, name: str, content: dict[str, Any]
) -> Description:
    """Return the checked description.

    Raises
    ------
    InputError
        A key is unknown or missing, or a value is not allowed; every fault is named.
    """
    try:
        return model.model_validate(content)
    except ValidationError as error:
        raise InputError(
            f"The {kind} '{name}' cannot be used: {explain_validation(error, model)}."
        ) from error


def read_description(model: type[Description], kind: str, folder: str, name: str) -> Description:
    """Find, read and check a description; see :func:`description_content` for the errors."""
    return validate_description(model, kind, name, description_content(kind, folder, name))
