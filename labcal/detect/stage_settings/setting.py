"""One setting: its name, unit, bounds and type in words, and the refusal of a value that it cannot have."""

from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any

from annotated_types import Ge, Gt, Le, Lt, MaxLen
from pydantic import ValidationError
from pydantic.fields import FieldInfo

from labcal.errors import InputError, UnknownNameError
from labcal.wording import clipped, shown

PREFIX = "detect"
"""Of the dotted name of every setting of detection."""
UNITS = {
    "px": "px",
    "px3": "px cubed",
    "per_px": "1/px",
    "deg": "degrees",
    "rad": "radians",
    "share": "of 1",
    "percent": "%",
    "factor": "times",
    "sigma": "standard deviations",
    "log": "natural logarithm of a ratio",
    "blurs": "blurs of the edge",
    "radii": "radii of the dot",
    "steps": "grid steps",
    "nodes": "grid nodes",
    "squares": "squares of the board",
    "sectors": "sectors of a ring",
}
"""Unit of a setting by the end of its name; a whole number whose name ends otherwise is a count."""
SettingValue = int | float | tuple[int | float, ...]
"""Of a setting."""


@dataclass(frozen=True)
class SettingDescription:
    """One setting, for help and documentation.

    Attributes
    ----------
    name : str
        Dotted, as :func:`~labcal.detect.settings.detect_settings` takes it: ``detect.edge.max_iterations``.
    default : int, float or tuple of them
    unit : str
    bounds : str
        For people, for example ``"2 to 1000"``.
    description : str
        Meaning and effect.
    """

    name: str
    default: SettingValue
    unit: str
    bounds: str
    description: str


def describe(stage: str, fields: Mapping[str, FieldInfo]) -> tuple[SettingDescription, ...]:
    """Return the settings of a stage in the order of their declaration."""
    return tuple(
        SettingDescription(
            f"{PREFIX}.{stage}.{name}",
            field.get_default(),
            _unit(name),
            _bounds(field),
            str(field.description),
        )
        for name, field in fields.items()
    )


def refusal(
    stage: str, fields: Mapping[str, FieldInfo], given: Mapping[str, object], error: ValidationError
) -> InputError:
    """Return the error that states which setting of a stage cannot have the value given, and why.

    Parameters
    ----------
    stage : str
    fields : mapping of str to FieldInfo
        Of the stage.
    given : mapping of str to object
        Values by name; numbers, or texts as they are typed.
    error : ValidationError
        What pydantic found.
    """
    known = {setting.name: setting for setting in describe(stage, fields)}
    fault = error.errors(include_url=False)[0]
    if not fault["loc"]:
        return InputError(f"The settings of {PREFIX}.{stage} contradict each other: {fault['ctx']['error']}.")
    field = str(fault["loc"][0])
    name = f"{PREFIX}.{stage}.{field}"
    if name not in known:
        return UnknownNameError("setting of detection", name, known)
    setting = known[name]
    return InputError(
        f"{name} should be {_kind(setting.default)} ({setting.bounds}; default {as_text(setting.default)}), "
        f"not {_as_given(given[field])}. {setting.description}"
    )


def as_text(value: SettingValue) -> str:
    """Return a value as it is typed."""
    return ",".join(as_text(part) for part in value) if isinstance(value, tuple) else f"{value!r}"


def _as_given(value: object) -> str:
    """Return a value that is refused for a message, a list as it is typed."""
    if isinstance(value, list | tuple):
        return f"'{clipped(','.join(part if isinstance(part, str) else shown(part) for part in value))}'"
    return f"'{clipped(value if isinstance(value, str) else shown(value))}'"


def _kind(default: SettingValue) -> str:
    """Return the words for the type of a setting."""
    if isinstance(default, tuple):
        return f"{len(default)} numbers with commas" if isinstance(default[0], int) else "numbers with commas"
    return "a whole number" if isinstance(default, int) else "a number"


def _unit(name: str) -> str:
    """Return the unit that ends the name of a setting."""
    endings = sorted(UNITS, key=len, reverse=True)
    return next((UNITS[ending] for ending in endings if name.endswith(f"_{ending}")), "count")


def _bounds(field: FieldInfo) -> str:
    """Return the bounds of a field, or those of each entry of a tuple, for people."""
    metadata: list[Any] = list(field.metadata)
    parts, suffix = getattr(field.annotation, "__args__", ()), ""
    if parts:
        most = next((f", at most {bound.max_length}" for bound in metadata if isinstance(bound, MaxLen)), "")
        metadata, suffix = list(getattr(parts[0], "__metadata__", ())), f" each{most}"
        metadata = [bound for part in metadata for bound in getattr(part, "metadata", [part])]
    lower = next((f"{bound.ge:g}" for bound in metadata if isinstance(bound, Ge)), None)
    lower = lower or next((f"above {bound.gt:g}" for bound in metadata if isinstance(bound, Gt)), "any")
    upper = next((f"to {bound.le:g}" for bound in metadata if isinstance(bound, Le)), None)
    upper = upper or next((f"to below {bound.lt:g}" for bound in metadata if isinstance(bound, Lt)), "")
    return f"{lower} {upper}{suffix}"
