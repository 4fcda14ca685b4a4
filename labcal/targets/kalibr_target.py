"""Kalibr's own description of a target, ``target.yaml``, and Basalt's, read as one of labcal's."""

from pathlib import Path
from typing import Any

from labcal.errors import InputError

_TYPE, _OFFSET = "target_type", "codeOffset"
_NUMBERS = {
    "tagCols": "a number of tags",
    "tagRows": "a number of tags",
    "tagSize": "a number of metres",
    "tagSpacing": "the gap between tags over their size",
}
_LARGEST_TAG_M = 3.0
"""Side of a tag above which a size is taken for one in another unit."""
_SPACINGS = (0.1, 1.0)
"""Gaps over sizes that a target may have."""


def is_kalibr_target(content: dict[str, Any]) -> bool:
    """Tell whether a description is Kalibr's, by its key ``target_type``, or Basalt's, by the other keys."""
    return _TYPE in content or ("kind" not in content and not _NUMBERS.keys().isdisjoint(content))


def from_kalibr(content: dict[str, Any], source: str) -> dict[str, Any]:
    """Return the description of the target that Kalibr's file states.

    Lengths, there in metres, are in mm here. Kalibr's prints have tags of 36h11 from 0 on, or from
    ``codeOffset`` on, with black borders two cells wide. Basalt's JSON files have the same keys without
    ``target_type``.

    Parameters
    ----------
    content : dict
        Of the file.
    source : str
        Its path, which names the target.

    Raises
    ------
    InputError
        It is of another kind than ``aprilgrid``, or a key is unknown, missing or no number. Or a size or a
        gap is in another unit than Kalibr's.
    """
    kind = content.get(_TYPE, "aprilgrid")
    if kind != "aprilgrid":
        raise InputError(
            f"The target '{source}' is Kalibr's, of target_type {kind!r:.40}; of Kalibr's kinds 'aprilgrid' "
            "is read. Describe a chessboard or a grid of dots as labcal does: `labcal target show "
            "chessboard-9x6`."
        )
    known = {_TYPE, _OFFSET, *_NUMBERS}
    odd = [f"'{key!s:.40}' is not known" for key in sorted(content.keys() - known, key=str)]
    odd += [f"'{key}' is missing" for key in sorted(_NUMBERS.keys() - content.keys())]
    for key, what in {**_NUMBERS, _OFFSET: "the id of the lower left tag"}.items():
        given = content.get(key, 0)
        if isinstance(given, bool) or not isinstance(given, int | float):
            odd.append(f"{key}: {given!r:.40} should be {what}")
    if not odd:
        odd = _other_units(float(content["tagSize"]), float(content["tagSpacing"]))
    if odd:
        raise InputError(f"The target '{source}', Kalibr's, cannot be used: {'; '.join(odd)}.")
    letters = "".join(
        letter if letter.isascii() and letter.isalnum() else "-" for letter in Path(source).stem
    )
    return {
        "kind": "aprilgrid",
        "name": letters.strip("-") or "aprilgrid",
        "description": f"Kalibr's target, tagSize {content['tagSize']:g} m",
        "tag_cols": content["tagCols"],
        "tag_rows": content["tagRows"],
        "tag_mm": round(1000.0 * content["tagSize"], 9),
        "tag_spacing": content["tagSpacing"],
        "first_id": content.get(_OFFSET, 0),
    }


def _other_units(size_m: float, spacing: float) -> list[str]:
    """Return what is wrong with a size in mm or cm, and with a gap in metres or mm."""
    odd = []
    if size_m > _LARGEST_TAG_M:
        odd.append(f"tagSize: {size_m:g} m is no tag's side; it is in metres, {size_m / 1000.0:g} for mm")
    least, most = _SPACINGS
    if size_m > 0.0 and not least <= spacing <= most:
        lengths = [spacing / size_m, spacing / size_m / 1000.0]
        share = next((gap for gap in lengths if least <= gap <= most), None)
        mend = f"; of a gap of {spacing:g} in a unit of length it is {share:.4g}" if share else ""
        what = f"the gap between tags over their size, {least:g} to {most:g}{mend}"
        odd.append(f"tagSpacing: {spacing:g} should be {what}")
    return odd
