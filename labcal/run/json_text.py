"""Writing of JSON: a value that does not apply is null."""

import dataclasses
import json
import math
from enum import Enum
from pathlib import PurePath
from typing import Any

import numpy as np
from pydantic import BaseModel

from labcal.errors import InputError, InputTypeError
from labcal.wording import json_escaped

IN_JSON = "labcal.in_json"
"""Key of the metadata of a dataclass's field, whose value is an :class:`InJson`."""


class InJson(Enum):
    """Places of a field of a dataclass in JSON, other than under its own name."""

    FLAT = "its own keys stand in the place of the field"
    ABSENT = "it is left out"


def to_json(document: object) -> str:
    """Return a document as JSON, indented, with a line feed at the end.

    NaN becomes null. Keys keep their order. Control characters, among them what turns the direction of
    writing, are escaped: a document may go to a terminal.

    Parameters
    ----------
    document : object
        A pydantic model, a dataclass, or plain data; in it also arrays, NumPy scalars, enums and paths.

    Raises
    ------
    InputError
        A number is infinite.
    InputTypeError
        A value, or the key of a mapping, has a type that JSON does not know.
    """
    text = json.dumps(plain_data(document), indent=2, ensure_ascii=False, allow_nan=False)
    return json_escaped(text) + "\n"


def plain_data(value: object, where: str = "$") -> Any:  # noqa: ANN401 - JSON is a union without a name
    """Return `value` made of dict, list, str, int, float, bool and None; see :func:`to_json`."""
    if isinstance(value, Enum):
        value = value.value
    if isinstance(value, np.ndarray | np.generic):
        value = value.tolist()
    if isinstance(value, PurePath):
        value = value.as_posix()
    if isinstance(value, float):
        return _finite_or_null(value, where)
    if value is None or isinstance(value, bool | int | str):
        return value
    if isinstance(value, list | tuple):
        return [plain_data(item, f"{where}[{index}]") for index, item in enumerate(value)]
    return {key: plain_data(item, f"{where}.{key}") for key, item in _members(value, where)}


def _members(value: object, where: str) -> list[tuple[str, Any]]:
    """Return the keys of an object and what they hold; items are left as they are, however deep."""
    if isinstance(value, BaseModel):
        fields = type(value).model_fields.items()
        return [(field.serialization_alias or name, getattr(value, name)) for name, field in fields]
    if dataclasses.is_dataclass(value) and not isinstance(value, type):
        members = []
        for field in dataclasses.fields(value):
            item, place = getattr(value, field.name), field.metadata.get(IN_JSON)
            if place is InJson.FLAT:
                members += _members(item, f"{where}.{field.name}")
            elif place is not InJson.ABSENT:
                members.append((field.name, item))
        return members
    if isinstance(value, dict):
        return [(_key(key, where), item) for key, item in value.items()]
    raise InputTypeError(f"{where} is of type {type(value).__name__}, which JSON does not know.")


def _finite_or_null(value: float, where: str) -> float | None:
    if math.isinf(value):
        raise InputError(
            f"{where} is infinite, which JSON cannot hold; give NaN (null) where a value is missing."
        )
    return None if math.isnan(value) else value


def _key(key: object, where: str) -> str:
    if not isinstance(key, str):
        raise InputTypeError(f"A key in {where} is {key!r}; JSON knows only text as keys.")
    return key
