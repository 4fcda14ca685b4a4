"""Tables with some elements changed: their columns cannot be written to."""

from dataclasses import replace
from typing import Any, TypeVar

import numpy as np

Table = TypeVar("Table")


def edited(table: Table, column: str, lines: object, value: object) -> Table:
    """Return a table with other values in some lines of a column."""
    changed: Any = np.array(getattr(table, column))
    changed[lines] = value
    return replace(table, **{column: changed})  # type: ignore[type-var]
