"""What views, cameras and targets may be called, since their names become parts of file names."""

import re
from typing import Annotated

from pydantic import Field

_PATTERN = r"^[A-Za-z0-9-]+$"

Name = Annotated[str, Field(pattern=_PATTERN)]
"""A name in a file: letters, digits and hyphens."""


def is_name(text: str) -> bool:
    """Return whether a text may be a name."""
    return re.fullmatch(_PATTERN, text) is not None
