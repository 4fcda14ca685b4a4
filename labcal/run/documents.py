"""JSON files that hold one pydantic model each."""

from pathlib import Path
from typing import TypeVar

from pydantic import BaseModel

from labcal.errors import InputError
from labcal.paths import AnyPath, as_path
from labcal.run.file_reading import MOST_OF_A_DOCUMENT, read_text
from labcal.run.json_reading import json_content, read_json
from labcal.wording import shown

Document = TypeVar("Document", bound=BaseModel)


def read_document(model: type[Document], what: str, path: AnyPath) -> Document:
    """Read and check a JSON file.

    Parameters
    ----------
    model : type
        What it holds.
    what : str
        What it is, for messages: ``"rig"``.
    path : path

    Raises
    ------
    InputError
        The file cannot be read, is something else, or comes from a newer version.
    """
    path = as_path(path)
    text = read_text(path, what, MOST_OF_A_DOCUMENT)
    _refuse_other_kind(model, json_content(text, f"The {what} {path}"), what, path)
    return read_json(model, text, f"The {what} {path}")


def _refuse_other_kind(model: type[BaseModel], content: object, what: str, path: Path) -> None:
    """Raise if a JSON file states another format, or a version that labcal does not read."""
    if not isinstance(content, dict):
        raise InputError(
            f"{path} is not a {what}: it holds {shown(content)}, not a mapping of keys to values."
        )
    expected = {
        key: model.model_fields[key].default
        for key in ("format", "format_version")
        if key in model.model_fields
    }
    kind = content.get("format", expected.get("format"))
    if "format" in expected and kind != expected["format"]:
        raise InputError(
            f"{path} is not a {what}: its 'format' is {shown(kind)}, not '{expected['format']}'. "
            "Give another file."
        )
    version, known = content.get("format_version"), expected.get("format_version")
    if isinstance(known, int) and isinstance(version, int) and version > known:
        raise InputError(
            f"The {what} {path} has format_version {shown(version)}, but this labcal reads up to {known}. "
            "Install a newer labcal."
        )
