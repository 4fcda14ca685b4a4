"""Kalibr's own description of a target, ``target.yaml``, read as one of labcal's."""

from pathlib import Path
from typing import Any

from labcal.errors import InputError

_NUMBERS = {
    "tagCols": "a number of tags",
    "tagRows": "a number of tags",
    "tagSize": "a number of metres",
    "tagSpacing": "the gap between tags over their size",
}
_APRILGRID = {"target_type", *_NUMBERS}


def is_kalibr_target(content: dict[str, Any]) -> bool:
    """Tell whether a description is Kalibr's, by its key ``target_type``."""
    return "target_type" in content


def from_kalibr(content: dict[str, Any], source: str) -> dict[str, Any]:
    """Return the description of the target that Kalibr's file states.

    Lengths, there in metres, are in mm here. Kalibr's prints have tags of 36h11 from 0 on, with black borders
    two cells wide.

    Parameters
    ----------
    content : dict
        Of the file.
    source : str
        Its path, which names the target.

    Raises
    ------
    InputError
        It is of another kind than ``aprilgrid``, or a key is unknown, missing or no number.
    """
    kind = content["target_type"]
    if kind != "aprilgrid":
        raise InputError(
            f"The target '{source}' is Kalibr's, of target_type {kind!r:.40}; of Kalibr's kinds 'aprilgrid' "
            "is read. Describe a chessboard or a grid of dots as labcal does: `labcal target show "
            "chessboard-9x6`."
        )
    odd = [f"'{key!s:.40}' is not known" for key in sorted(content.keys() - _APRILGRID, key=str)]
    odd += [f"'{key}' is missing" for key in sorted(_APRILGRID - content.keys())]
    size = content.get("tagSize")
    for key, what in _NUMBERS.items():
        given = content.get(key, 0)
        if isinstance(given, bool) or not isinstance(given, int | float):
            odd.append(f"{key}: {given!r:.40} should be {what}")
    if odd or not isinstance(size, int | float):
        raise InputError(f"The target '{source}', Kalibr's, cannot be used: {'; '.join(odd)}.")
    letters = "".join(
        letter if letter.isascii() and letter.isalnum() else "-" for letter in Path(source).stem
    )
    return {
        "kind": "aprilgrid",
        "name": letters.strip("-") or "aprilgrid",
        "description": f"Kalibr's target, tagSize {size:g} m",
        "tag_cols": content["tagCols"],
        "tag_rows": content["tagRows"],
        "tag_mm": round(1000.0 * size, 9),
        "tag_spacing": content["tagSpacing"],
    }
