"""JSON files that hold one pydantic model each."""

from pathlib import Path
from typing import TypeVar

from pydantic import BaseModel

from labcal.errors import InputError
from labcal.run.file_reading import MOST_OF_A_DOCUMENT, read_bytes
from labcal.run.json_reading import read_json

Document = TypeVar("Document", bound=BaseModel)


def read_document(model: type[Document], what: str, path: Path) -> Document:
    """Read and check a JSON file.

    Parameters
    ----------
    model : type
        What it holds.
    what : str
        What it is, for messages: ``"rig"``.
    path : Path

    Raises
    ------
    InputError
        The file cannot be read, is something else, or comes from a newer version.
    """
    source = f"{path} is not a {what} that this version reads: it"
    try:
        text = read_bytes(path, what, MOST_OF_A_DOCUMENT).decode("utf-8-sig")
    except UnicodeDecodeError as error:
        raise InputError(f"{source} is no text in UTF-8 ({error}).") from error
    return read_json(model, text, source)
