"""JSON files that hold one pydantic model each."""

from pathlib import Path
from typing import TypeVar

from pydantic import BaseModel

from labcal.run.file_reading import MOST_OF_A_DOCUMENT, read_text
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
    text = read_text(path, what, MOST_OF_A_DOCUMENT)
    return read_json(model, text, f"{path} is not a {what} that this version reads: it")
