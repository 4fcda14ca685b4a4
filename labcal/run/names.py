"""Names of views, cameras and targets, which become parts of file names."""

import re
from collections.abc import Iterable
from typing import Annotated

from pydantic import Field

_PATTERN = r"^[A-Za-z0-9-]+$"

Name = Annotated[str, Field(pattern=_PATTERN)]
"""A name in a file: letters, digits and hyphens."""


def is_name(text: str) -> bool:
    """Return whether a text may be a name."""
    return re.fullmatch(_PATTERN, text) is not None


def differ_in_case(names: Iterable[str]) -> tuple[str, str] | None:
    """Return two names that differ only in capital letters; None where there are none.

    On disks of macOS and Windows files with such names are one file.
    """
    known: dict[str, str] = {}
    for name in names:
        other = known.setdefault(name.casefold(), name)
        if other != name:
            return other, name
    return None
