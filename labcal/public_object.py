"""Equality by value and display, common to the public objects."""

from collections.abc import Mapping, Sequence
from dataclasses import fields, is_dataclass
from html import escape
from typing import NamedTuple

import numpy as np
from pydantic import BaseModel

from labcal.wording import printable


class HtmlTable(NamedTuple):
    """A table that an object shows in a notebook below its summary."""

    header: Sequence[str]
    rows: Sequence[Sequence[str]]


class PublicObject:
    """An object that compares by value and shows itself in one line, or as a table in a notebook.

    A class derives from it, before :class:`pydantic.BaseModel` where it is one, and says what it holds in
    `_summary`; a dataclass is declared with ``eq=False, repr=False``, so that the methods here are its own.
    """

    def __eq__(self, other: object) -> bool:
        """Tell whether two objects hold the same, where NaN is equal to NaN."""
        if type(other) is not type(self):
            return NotImplemented
        return same_value(self._compared(), other._compared())

    __hash__ = None  # type: ignore[assignment] # equal objects of arrays have no common hash

    def __repr__(self) -> str:
        summary = ", ".join(f"{name}={_text(value)}" for name, value in self._summary().items())
        return printable(f"{type(self).__name__}({' '.join(summary.splitlines())})")

    def __str__(self) -> str:
        return repr(self)

    def _repr_html_(self) -> str:
        """Return a table for notebooks."""
        summary = [[name.replace("_", " "), _cell(value)] for name, value in self._summary().items()]
        tables = [HtmlTable((type(self).__name__, ""), summary), *self._html_tables()]
        return "<div>" + "".join(_html(table) for table in tables if table.rows) + "</div>"

    def _summary(self) -> Mapping[str, object]:
        """Return what the object holds, in a few short values by name."""
        raise NotImplementedError

    def _html_tables(self) -> Sequence[HtmlTable]:
        """Return the tables that a notebook shows below the summary; one without rows is left out."""
        return ()

    def _compared(self) -> object:
        """Return what two objects must have in common to be equal."""
        if isinstance(self, BaseModel):
            return dict(self)
        if is_dataclass(self):
            return {field.name: getattr(self, field.name) for field in fields(self) if field.compare}
        return vars(self)


def same_value(one: object, other: object) -> bool:
    """Tell whether two values are the same, where NaN is equal to NaN and arrays are compared whole.

    Examples
    --------
    >>> same_value({"q": np.array([1.0, np.nan])}, {"q": np.array([1.0, np.nan])})
    True
    >>> same_value(np.zeros(2), np.zeros(3))
    False
    """
    if isinstance(one, np.ndarray) and isinstance(other, np.ndarray):
        floats = one.dtype.kind in "fc" and other.dtype.kind in "fc"
        return np.array_equal(one, other, equal_nan=floats)
    if type(one) is not type(other):
        return False
    same: object
    if isinstance(one, Mapping) and isinstance(other, Mapping):
        same = one.keys() == other.keys() and all(same_value(one[key], other[key]) for key in one)
    elif isinstance(one, list | tuple) and isinstance(other, list | tuple):
        same = len(one) == len(other) and all(map(same_value, one, other))
    elif isinstance(one, PublicObject) or not is_dataclass(one):
        same = one == other or (one != one and other != other)  # noqa: PLR0124 -- NaN is not itself
    else:
        names = [field.name for field in fields(one) if field.compare]
        same = all(same_value(getattr(one, name), getattr(other, name)) for name in names)
    return bool(same)


def _text(value: object) -> str:
    """Return a value in few letters."""
    if isinstance(value, float):
        return f"{value:.4g}"
    return value if isinstance(value, str) else repr(value)


def _cell(value: object) -> str:
    """Return a value as a cell of a table, names without brackets and quotation marks."""
    return ", ".join(map(_text, value)) if isinstance(value, list | tuple) else _text(value)


def _html(table: HtmlTable) -> str:
    """Return a table as HTML, in which nothing of what it holds is taken for HTML."""
    header = "".join(f"<th>{escape(printable(cell))}</th>" for cell in table.header)
    rows = ("".join(f"<td>{escape(printable(cell))}</td>" for cell in row) for row in table.rows)
    body = "".join(f"<tr>{row}</tr>" for row in rows)
    return f"<table><thead><tr>{header}</tr></thead><tbody>{body}</tbody></table>"
