"""Numbers that OpenCV writes as base64 (``cv::FileStorage::WRITE_BASE64``): their type, then bytes."""

import base64
import binascii
import re
from collections.abc import Mapping
from pathlib import Path

import numpy as np

from labcal.errors import InputError

MARK = "$base64$"
"""Stands before them in JSON, and here also before those of YAML and XML."""
_HEADER = 24
"""Bytes that tell the type of the elements, such as ``9d``, padded with blanks."""
_TYPE = re.compile(rb"\d{0,3}([ucwsifdh]) *")
_DTYPES = {"u": "<u1", "c": "<i1", "w": "<u2", "s": "<i2", "i": "<i4", "f": "<f4", "d": "<f8", "h": "<f2"}
_PARTS = ("data", "sizes")
"""Keys of a matrix that hold them."""


def marked(text: str) -> str:
    """Return base64 with the mark, in one line."""
    return MARK + "".join(text.split())


def with_numbers(content: Mapping[str, object], path: Path) -> dict[str, object]:
    """Return the content of a file with lists of numbers in place of marked base64.

    Raises
    ------
    InputError
        It is damaged, or holds other elements than numbers of one type.
    """
    return {key: _numbers(value, key, path) for key, value in content.items()}


def _numbers(value: object, key: str, path: Path) -> object:
    """Return numbers in place of base64, also within a matrix; anything else as it is."""
    if isinstance(value, dict):
        return {part: _numbers(one, key, path) if part in _PARTS else one for part, one in value.items()}
    if not isinstance(value, str) or not value.startswith(MARK):
        return value
    try:
        data = base64.b64decode(value.removeprefix(MARK), validate=True)
        found = _TYPE.fullmatch(data[:_HEADER])
        letter = "" if found is None else found[1].decode()
        return np.frombuffer(data[_HEADER:], _DTYPES[letter]).astype(np.float64).tolist()
    except (binascii.Error, ValueError, KeyError) as error:
        raise InputError(
            f"{path}: the base64 of {key:.40} is damaged, or holds no numbers of one type. Write the file "
            "again, without cv::FileStorage::BASE64."
        ) from error
