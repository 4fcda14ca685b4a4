"""OpenCV's FileStorage as text: a flat list of numbers, words and matrices, in YAML or XML.

It is read here and not by OpenCV, so that a damaged or hostile file meets checked code only.
"""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from xml.etree.ElementTree import Element

import numpy as np

from labcal.cameras.interop.exchange import SourceText
from labcal.cameras.interop.numbers_text import finite_number, finite_numbers, number_text
from labcal.cameras.interop.xml_tree import read_xml_tree
from labcal.cameras.interop.yaml_tree import read_yaml_tree
from labcal.errors import InputError

Content = Mapping[str, int | str | np.ndarray]
"""Content of a file to write, by key."""
_ROOT = "opencv_storage"
_SIDES = ("rows", "cols")


@dataclass(frozen=True)
class Storage:
    """Content of a file that was read, by key."""

    path: Path
    content: Mapping[str, object]
    mapped: frozenset[str] = frozenset()
    """Keys that a user has given another name to; they go before the rest."""

    def first(self, keys: Sequence[str]) -> object:
        """Return what the first of these keys that is there holds; None where none is."""
        chosen = [key for key in keys if key in self.mapped] or keys
        return next((self.content[key] for key in chosen if key in self.content), None)

    def text(self, key: str) -> str | None:
        """Return a word, or None."""
        value = self.content.get(key)
        return value if isinstance(value, str) else None

    def matrix(self, keys: Sequence[str], counts: Sequence[int]) -> tuple[float, ...]:
        """Return the numbers of a matrix, row by row.

        Raises
        ------
        InputError
            There is none under these keys, it is damaged, or has another number of elements than `counts`.
        """
        value = self.first(keys)
        if value is None:
            raise InputError(f"{self.path} has no {keys[0]} (a matrix of OpenCV).")
        # An array of one dimension is stored as a list where it is short, else with its "sizes".
        data = value.get("data") if isinstance(value, dict) else value
        numbers = finite_numbers(data, counts, keys[0], self.path)
        if isinstance(value, dict):
            require_shape(value, len(numbers), keys[0], self.path)
        return numbers


def require_shape(matrix: Mapping[str, object], count: int, what: str, path: Path) -> None:
    """Raise where rows and columns that a matrix states are not as many as its numbers.

    Raises
    ------
    InputError
        They are not, or are no numbers.
    """
    stated = [matrix[key] for key in _SIDES if key in matrix]
    sides = [one[0] if isinstance(one, list) and len(one) == 1 else one for one in stated]
    whole = [finite_number(side, "rows and cols", path) for side in sides]
    if len(whole) == len(_SIDES) and whole[0] * whole[1] != count:
        raise InputError(f"{path}: {what} states {sides[0]} x {sides[1]} numbers, but holds {count}.")


def read_storage(source: SourceText) -> Storage:
    """Read a file.

    Raises
    ------
    InputError
        It is neither YAML nor XML of OpenCV's form.
    """
    if source.text.lstrip().startswith("<"):
        root = read_xml_tree(source.text, source.path)
        if root.tag != _ROOT:
            raise InputError(
                f"{source.path}: the outermost element should be {_ROOT}, but is {root.tag:.40}."
            )
        tags = [child.tag for child in root]
        twice = next((tag for tag in tags if tags.count(tag) > 1), None)
        if twice is not None:
            raise InputError(f"{source.path}: the key {twice:.40} occurs twice. Leave one of them.")
        return Storage(source.path, {child.tag: _value(child) for child in root})
    return Storage(source.path, read_yaml_tree(source.text, source.path))


def storage_text(content: Content, suffix: str) -> str:
    """Return the text of a file; XML where the ending of its name is ``.xml``."""
    if suffix.lower() == ".xml":
        entries = "".join(_xml_entry(key, value) for key, value in content.items())
        return f'<?xml version="1.0"?>\n<{_ROOT}>\n{entries}</{_ROOT}>\n'
    entries = "".join(_yaml_entry(key, value) for key, value in content.items())
    return f"%YAML:1.0\n---\n{entries}"


def _value(element: Element) -> object:
    """Return a matrix as a mapping, several words as a list, and one as a word."""
    if len(element):
        return {child.tag: (child.text or "").split() for child in element}
    words = (element.text or "").split()
    return words if len(words) > 1 else " ".join(words).strip('"')


def _yaml_entry(key: str, value: int | str | np.ndarray) -> str:
    if isinstance(value, np.ndarray):
        rows, cols = value.shape
        return (
            f"{key}: !!opencv-matrix\n   rows: {rows}\n   cols: {cols}\n   dt: d\n"
            f"   data: [ {', '.join(number_text(number) for number in value.ravel())} ]\n"
        )
    return f'{key}: "{value}"\n' if isinstance(value, str) else f"{key}: {value}\n"


def _xml_entry(key: str, value: int | str | np.ndarray) -> str:
    if isinstance(value, np.ndarray):
        rows, cols = value.shape
        return (
            f'<{key} type_id="opencv-matrix">\n  <rows>{rows}</rows>\n  <cols>{cols}</cols>\n  <dt>d</dt>\n'
            f"  <data>\n    {' '.join(number_text(number) for number in value.ravel())}</data></{key}>\n"
        )
    # Quoted, since a name of digits would be read as a number.
    return f'<{key}>"{value}"</{key}>\n' if isinstance(value, str) else f"<{key}>{value}</{key}>\n"
