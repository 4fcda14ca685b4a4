"""JSON files that hold one pydantic model each."""

from pathlib import Path
from typing import TypeVar

from pydantic import BaseModel, ValidationError

from labcal.errors import InputError
from labcal.run.descriptions import explain_validation

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
    try:
        return model.model_validate_json(path.read_bytes())
    except OSError as error:
        raise InputError(f"The {what} {path} cannot be read: {error.strerror}.") from error
    except ValidationError as error:
        raise InputError(
            f"{path} is not a {what} that this version reads: {explain_validation(error)}."
        ) from error
