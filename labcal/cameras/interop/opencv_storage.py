"""OpenCV's FileStorage as text: a flat list of numbers, words and matrices, in YAML or XML.

It is read here and not by OpenCV, so that a damaged or hostile file meets checked code only.
"""

import math
import re
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from xml.etree.ElementTree import Element

import numpy as np

from labcal.cameras.interop.exchange import SourceText
from labcal.cameras.interop.nested_keys import without_nesting
from labcal.cameras.interop.numbers_text import finite_number, finite_numbers, number_text
from labcal.cameras.interop.numpy_archive import archived_numbers, is_archive
from labcal.cameras.interop.opencv_base64 import marked, with_numbers
from labcal.cameras.interop.opencv_names import named_so
from labcal.cameras.interop.xml_tree import read_xml_tree
from labcal.cameras.interop.yaml_tree import read_yaml_tree
from labcal.errors import InputError

Content = Mapping[str, int | str | np.ndarray]
"""Content of a file to write, by key."""
_ROOT, _ITEM = "opencv_storage", "_"
"""The outermost element, and that of an item of a list."""
_BINARY = "binary"
"""Type of an element whose text is base64."""
_SIDES = ("rows", "cols")
_PYTHON = "!!python/"
_BETWEEN = re.compile(r"^(?:---|\.\.\.)[ \t\r]*$", re.MULTILINE)
_CONTENT = re.compile(r"^[^#%\s]", re.MULTILINE)
_CHANNELS = re.compile(r"\W*(\d{1,3})[a-z]")
"""Of the type of a matrix, "5d": numbers in each element."""


@dataclass(frozen=True)
class Storage:
    """Content of a file that was read, by key."""

    path: Path
    content: Mapping[str, object]
    mapped: frozenset[str] = frozenset()
    """Keys that a user has given another name to; they go before the rest."""

    @property
    def listed(self) -> str:
        """The keys, for messages."""
        own = [str(key) for key in self.content if key not in self.mapped]
        return ", ".join(own)[:300] or "none"

    def there(self, keys: Sequence[str]) -> list[str]:
        """Return the names under which some of these keys are there; those that a user maps go first."""
        mapped = [key for key in keys if key in self.mapped]
        return mapped or named_so(keys, [key for key in self.content if isinstance(key, str)])

    def first(self, keys: Sequence[str]) -> object:
        """Return what the first of these keys that is there holds; None where none is."""
        return next((self.content[key] for key in self.there(keys)), None)

    def text(self, key: str) -> str | None:
        """Return a word, or None."""
        value = self.content.get(key)
        return value if isinstance(value, str) else None

    def numbers(self, key: str) -> list[object]:
        """Return the elements of what may be a matrix, row by row, unchecked; none of anything else."""
        value = self.content.get(key)
        data = _in_one_list(value.get("data") if isinstance(value, dict) else value)
        return data if isinstance(data, list) else []

    def row_count(self, key: str) -> int | None:
        """Return how many rows a matrix has; None where its numbers stand in one list without a shape."""
        value = self.content.get(key)
        if isinstance(value, dict):
            return int(str(value["rows"])) if str(value.get("rows")).isdecimal() else None
        nested = isinstance(value, list) and value and isinstance(value[0], list)
        return len(value) if nested and isinstance(value, list) else None

    def matrix(self, keys: Sequence[str], counts: Sequence[int]) -> tuple[float, ...]:
        """Return the numbers of a matrix, row by row.

        Raises
        ------
        InputError
            There is none under these keys, it is damaged, or has another number of elements than `counts`.
        """
        there = self.there(keys)
        if not there:
            raise InputError(f"{self.path} has no {keys[0]} (a matrix of OpenCV).")
        # Of several keys those count whose matrices can be meant: CameraMatrix may be a pose.
        fitting = [key for key in there if len(self.numbers(key)) in counts] or there[:1]
        value = self.content[fitting[0]]
        if any(self.content[key] != value for key in fitting):
            raise InputError(
                f"{self.path} has {' and '.join(fitting)}, which differ. Say which holds: "
                f"`key='{keys[0]}={fitting[0]}'`."
            )
        # An array of one dimension is stored as a list where it is short, else with its "sizes".
        data = value.get("data") if isinstance(value, dict) else value
        if isinstance(data, (int, float, str)) and 1 in counts:
            data = [data]
        numbers = finite_numbers(_in_one_list(data), counts, fitting[0], self.path)
        if isinstance(value, dict):
            require_shape(value, len(numbers), fitting[0], self.path)
        return numbers


def _in_one_list(data: object) -> object:
    """Return the rows of a matrix one after the other; anything else as it is."""
    while isinstance(data, list) and data and all(isinstance(row, list) for row in data):
        data = [number for row in data for number in row]
    return data


def require_shape(matrix: Mapping[str, object], count: int, what: str, path: Path) -> None:
    """Raise where rows and columns that a matrix states, or its sizes, are not as many as its numbers.

    Raises
    ------
    InputError
        They are not, or are no numbers.
    """
    stated = [matrix[key] for key in _SIDES if key in matrix]
    sides = [one[0] if isinstance(one, list) and len(one) == 1 else one for one in stated]
    if len(sides) != len(_SIDES):
        listed = matrix.get("sizes")
        sides = listed if isinstance(listed, list) else []
    whole = [finite_number(side, "rows and cols", path) for side in sides]
    channels = _CHANNELS.match(str(matrix.get("dt")))
    if whole and math.prod(whole) * (int(channels[1]) if channels else 1) != count:
        shape = " x ".join(map(str, sides)) + (f" x {channels[1]}" if channels else "")
        raise InputError(f"{path}: {what} states {shape} numbers, but holds {count}.")


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
        return _storage(_mapping(root, source.path), source.path)
    if _PYTHON in source.text:
        raise InputError(
            f"{source.path} holds objects of Python, as yaml.dump writes NumPy's arrays, which are not read. "
            "Write lists of numbers: array.tolist()."
        )
    is_json = source.text.lstrip().startswith("{")
    text = source.text.replace("\t", " ") if is_json else source.text  # YAML takes no tabs
    return _storage(_documents(text, source.path), source.path)


def _storage(content: Mapping[str, object], path: Path) -> Storage:
    """Return a file by its content, with the keys within keys and what stands in base64."""
    return Storage(path, with_numbers(without_nesting(content), path))


def _documents(text: str, path: Path) -> dict[str, object]:
    """Return the keys of all documents in a file: cv::FileStorage::APPEND adds one behind the others."""
    parts = [part for part in _BETWEEN.split(text) if _CONTENT.search(part)] or [text]
    content: dict[str, object] = {}
    for part in parts:
        document = read_yaml_tree(part, path)
        twice = next((key for key in document if key in content), None)
        if twice is not None:
            raise InputError(
                f"{path}: the key {twice!s:.40} occurs twice, in two documents. Leave one of them."
            )
        content |= document
    return content


def storage_text(content: Content, suffix: str) -> str:
    """Return the text of a file; XML where the ending of its name is ``.xml``."""
    if suffix.lower() == ".xml":
        entries = "".join(_xml_entry(key, value) for key, value in content.items())
        return f'<?xml version="1.0"?>\n<{_ROOT}>\n{entries}</{_ROOT}>\n'
    entries = "".join(_yaml_entry(key, value) for key, value in content.items())
    return f"%YAML:1.0\n---\n{entries}"


def _mapping(element: Element, path: Path) -> dict[str, object]:
    """Return what is within an element, by key."""
    tags = [child.tag for child in element if child.tag != _ITEM]
    twice = next((tag for tag in tags if tags.count(tag) > 1), None)
    if twice is not None:
        raise InputError(f"{path}: the key {twice:.40} occurs twice. Leave one of them.")
    return {child.tag: _value(child, path) for child in element}


def _value(element: Element, path: Path) -> object:
    """Return a matrix as a mapping, keys within a key as one, several words as a list, and one as a word."""
    if len(element) and element.find("data") is None and element.get("type_id") is None:
        return _mapping(element, path)
    if len(element):
        return {
            child.tag: marked(child.text or "")
            if child.get("type_id") == _BINARY
            else (child.text or "").split()
            for child in element
        }
    if element.get("type_id") == _BINARY:
        return marked(element.text or "")
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
