"""Reading of JSON: each key once, finite numbers, limited depth."""

import json
from collections import Counter
from typing import Any, NoReturn, TypeVar

from pydantic import BaseModel, ValidationError

from labcal.errors import InputError
from labcal.run.descriptions import explain_validation
from labcal.wording import clipped, shown

Document = TypeVar("Document", bound=BaseModel)


def json_content(text: str, source: str) -> object:
    """Return the content of a JSON text.

    Parameters
    ----------
    text : str
    source : str
        Where it comes from, at the beginning of a sentence.

    Raises
    ------
    InputError
        The text is no JSON, a key occurs twice, or a number is NaN, infinite or of thousands of digits.
    """
    try:
        return json.loads(text, object_pairs_hook=_each_once, parse_constant=_refuse_constant)
    except (ValueError, RecursionError) as error:
        reason = clipped(str(error), 300) or type(error).__name__
        raise InputError(f"{source} is not valid JSON: {reason}.") from error


def read_json(model: type[Document], text: str, source: str) -> Document:
    """Return a document from a JSON text, checked; `source` is as of :func:`json_content`.

    Raises
    ------
    InputError
        As of :func:`json_content`, or the document is of another kind or version.
    """
    json_content(text, source)
    try:
        return model.model_validate_json(text)
    except ValidationError as error:
        raise InputError(f"{source} cannot be used: {explain_validation(error)}.") from error


def _each_once(pairs: list[tuple[str, Any]]) -> dict[str, Any]:
    content = dict(pairs)
    if len(content) < len(pairs):
        number = Counter(key for key, _ in pairs)
        twice = next(key for key, times in number.items() if times > 1)
        raise ValueError(f"the key {shown(twice)} occurs twice in one object")
    return content


def _refuse_constant(word: str) -> NoReturn:
    raise ValueError(f"{word} is no number of JSON")
