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
from labcal.cameras.interop.numpy_archive import archived_numbers, is_archive
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

    def numbers(self, key: str) -> list[object]:
        """Return the elements of what may be a matrix, row by row, unchecked; none of anything else."""
        value = self.content.get(key)
        data = _in_one_list(value.get("data") if isinstance(value, dict) else value)
        return data if isinstance(data, list) else []

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
        self._require_one(keys)
        data = value.get("data") if isinstance(value, dict) else value
        numbers = finite_numbers(_in_one_list(data), counts, keys[0], self.path)
        if isinstance(value, dict):
            require_shape(value, len(numbers), keys[0], self.path)
        return numbers

    def _require_one(self, keys: Sequence[str]) -> None:
        """Raise where several of these keys are there and hold different things."""
        if set(keys) & self.mapped:
            return
        there = [key for key in keys if key in self.content]
        if any(self.content[key] != self.content[there[0]] for key in there):
            raise InputError(
                f"{self.path} has {' and '.join(there)}, which differ. Say which holds: "
                f"`key='{keys[0]}={there[0]}'`."
            )


def _in_one_list(data: object) -> object:
    """Return the rows of a matrix one after the other; anything else as it is."""
    while isinstance(data, list) and data and all(isinstance(row, list) for row in data):
        data = [number for row in data for number in row]
    return data


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
        It is neither YAML nor XML of OpenCV's form, nor an archive of NumPy, or it is damaged.
    """
    if is_archive(source.text):
        return Storage(source.path, archived_numbers(source.data, source.path))
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
    is_json = source.text.lstrip().startswith("{")
    text = source.text.replace("\t", " ") if is_json else source.text  # YAML takes no tabs
    return Storage(source.path, _with_nested(read_yaml_tree(text, source.path)))


def _with_nested(content: dict[str, object]) -> dict[str, object]:
    """Return the content with the keys within a key, such as ``left``, as ``left_camera_matrix``, too."""
    nested = {
        f"{outer}_{inner}": value
        for outer, inside in content.items()
        if isinstance(inside, dict) and "data" not in inside
        for inner, value in inside.items()
    }
    return {**nested, **content}


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
