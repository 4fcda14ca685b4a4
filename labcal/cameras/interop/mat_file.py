"""MATLAB's MAT-files of level 5 (``save -v7`` and ``-v6``): arrays of numbers, words and structs.

The layout is that of MathWorks' document "MAT-File Format". It is read here and not by SciPy, so that a
damaged or hostile file meets checked code only.
"""

import struct
import zlib
from collections.abc import Mapping
from pathlib import Path
from typing import Any

import numpy as np

from labcal.errors import InputError

HEADER = b"MATLAB 5.0 MAT-file"
_HDF5 = b"MATLAB 7.3 MAT-file"
_HEADER_BYTES, _TAG_BYTES, _SMALL = 128, 8, 4
_MATRIX, _COMPRESSED = 14, 15
_NUMBERS = {
    1: "i1", 2: "u1", 3: "i2", 4: "u2", 5: "i4", 6: "u4", 7: "f4", 9: "f8", 12: "i8", 13: "u8",
}  # fmt: skip
_WORDS = {16: "utf-8", 17: "utf-16", 18: "utf-32", 1: "latin-1", 2: "latin-1", 4: "utf-16"}
_STRUCT, _CHAR, _DOUBLE = 2, 4, 6
_OPAQUE = 17
"""An object of MATLAB, whose layout is not published."""
_FLAGS, _ROWS_AND_COLUMNS = 2, 2
"""Least numbers of flags (the class, and room in sparse arrays) and of dimensions."""
_CLASSES = {1: "a cell array", 3: "an object", 5: "a sparse matrix", 16: "a function", _OPAQUE: "an object"}
_NUMERIC = range(6, 16)
_MOST_BYTES = 2**24
_MOST_DEEP, _MOST_FIELDS = 20, 1000
_COMPLEX = 0x0800
_OF_A_NAME = 32


class Unread:
    """A value of a class that is not read."""

    def __init__(self, kind: str) -> None:
        self.kind = kind


Value = np.ndarray | str | Unread | Mapping[str, Any]
"""An array of numbers, a text, what is not read, or a struct: such values by their fields."""


class _Elements:
    """Elements one after the other, each with a type and its bytes."""

    def __init__(self, data: bytes, order: str, path: Path) -> None:
        self.order, self.path = order, path
        self._data, self._at = data, 0

    @property
    def is_done(self) -> bool:
        """True if all elements have been taken."""
        return self._at >= len(self._data)

    def take(self) -> tuple[int, bytes]:
        """Return type and bytes of the next element."""
        if len(self._data) - self._at < _TAG_BYTES:
            raise self.damaged("it ends too early")
        kind, size = struct.unpack_from(f"{self.order}II", self._data, self._at)
        start = self._at + _TAG_BYTES
        if kind >> 16:  # a small element: its size stands in the upper half, its bytes in place of the size
            kind, size, start = kind & 0xFFFF, kind >> 16, self._at + _SMALL
            if size > _SMALL:
                raise self.damaged("an element is larger than its place")
        if size > len(self._data) - start:
            raise self.damaged("it ends too early")
        end = start + size
        padded = end if kind == _COMPRESSED else -(-end // _TAG_BYTES) * _TAG_BYTES
        self._at = min(padded, len(self._data))
        return kind, self._data[start:end]

    def numbers(self, what: str) -> np.ndarray:
        """Return the next element's numbers."""
        kind, data = self.take()
        if kind not in _NUMBERS:
            raise self.damaged(f"{what} is of the type {kind}, which is none of numbers")
        dtype = np.dtype(self.order + _NUMBERS[kind])
        if len(data) % dtype.itemsize:
            raise self.damaged(f"{what} has {len(data)} bytes, which are no whole numbers")
        return np.frombuffer(data, dtype)

    def inside(self, data: bytes) -> "_Elements":
        """Return the elements in the bytes of one."""
        return _Elements(data, self.order, self.path)

    def damaged(self, why: str) -> InputError:
        """Return the error for a file that cannot be read on."""
        return InputError(f"{self.path} is damaged: {why}. Save it again in MATLAB with '-v7'.")


def read_mat(data: bytes, path: Path) -> dict[str, Value]:
    """Return the variables of a file by name.

    Raises
    ------
    InputError
        It is no MAT-file of level 5, it is damaged, or two variables have one name.
    """
    if data.startswith((_HDF5, b"\x89HDF")):
        raise InputError(f"{path} was saved with '-v7.3'. Save it in MATLAB with '-v7'.")
    order = {b"IM": "<", b"MI": ">"}.get(data[_HEADER_BYTES - 2 : _HEADER_BYTES])
    if order is None:
        raise InputError(f"{path} is no MAT-file of level 5. Save it in MATLAB with '-v7'.")
    left = _Elements(data[_HEADER_BYTES:], order, path)
    variables: dict[str, Value] = {}
    while not left.is_done:
        kind, content = left.take()
        if kind == _COMPRESSED:
            kind, content = left.inside(_inflated(content, left)).take()
        if kind != _MATRIX:
            raise left.damaged(f"a variable is of the type {kind}")
        name, value = _matrix(left.inside(content), 0)
        if name in variables:
            raise left.damaged(f"the variable '{name:.40}' occurs twice")
        variables[name] = value
    return variables


def _inflated(data: bytes, left: _Elements) -> bytes:
    """Return bytes that were compressed, not too many of them."""
    machine = zlib.decompressobj()
    try:
        inflated = machine.decompress(data, _MOST_BYTES)
    except zlib.error as error:
        raise left.damaged(str(error)) from error
    if not machine.eof:
        raise left.damaged("a variable is truncated, or far too large")
    return inflated


def _matrix(left: _Elements, depth: int) -> tuple[str, Value]:
    """Return name and value of an array."""
    if depth > _MOST_DEEP:
        raise left.damaged("structs lie in each other too deep")
    flags = left.numbers("the flags of an array")
    if flags.dtype.kind != "u" or len(flags) < _FLAGS:
        raise left.damaged("an array has no flags")
    kind = int(flags[0]) & 0xFF
    if kind == _OPAQUE:
        return _word(left, "a name"), Unread(_CLASSES[kind])
    dims = left.numbers("the dimensions of an array")
    name = _word(left, "a name")
    if dims.dtype.kind != "i" or len(dims) < _ROWS_AND_COLUMNS or (dims < 0).any():
        raise left.damaged(f"'{name:.40}' has no dimensions")
    count = int(np.prod(dims.astype(object)))
    if kind == _STRUCT:
        return name, _struct(left, count, depth)
    if kind == _CHAR:
        return name, _text(left, count)
    if kind not in _NUMERIC or int(flags[0]) & _COMPLEX:
        return name, Unread("complex" if kind in _NUMERIC else _CLASSES.get(kind, f"of the class {kind}"))
    return name, _array(left, [int(one) for one in dims], name)


def _array(left: _Elements, shape: list[int], name: str) -> np.ndarray:
    """Return the next element as an array of numbers."""
    values = left.numbers(f"'{name:.40}'")
    if len(values) != int(np.prod(np.array(shape, dtype=object))):
        raise left.damaged(f"'{name:.40}' has {len(values)} numbers, which are none of its shape")
    return values.astype(np.float64).reshape(shape, order="F")


def _struct(left: _Elements, count: int, depth: int) -> Value:
    """Return a struct by its fields; of arrays of structs nothing is read."""
    lengths = left.numbers("a length of names")
    length = int(lengths[0]) if len(lengths) == 1 else 0
    _, data = left.take()
    if length < 1 or len(data) % length or len(data) // length > _MOST_FIELDS:
        raise left.damaged("a struct has no names of fields")
    if count != 1:
        return Unread("an array of structs")
    fields: dict[str, Value] = {}
    for at in range(0, len(data), length):
        field = data[at : at + length].split(b"\0")[0].decode("latin-1")
        kind, content = left.take()
        if kind != _MATRIX or field in fields:
            raise left.damaged(f"the field '{field:.40}' is no array, or occurs twice")
        fields[field] = _matrix(left.inside(content), depth + 1)[1] if content else np.zeros((0, 0))
    return fields


def _word(left: _Elements, what: str) -> str:
    """Return the next element as a name."""
    kind, data = left.take()
    if kind not in _WORDS:
        raise left.damaged(f"{what} is of the type {kind}")
    return data.decode("latin-1")


def _text(left: _Elements, count: int) -> Value:
    """Return the next element as a text."""
    kind, data = left.take()
    if kind not in _WORDS:
        raise left.damaged(f"a text is of the type {kind}")
    name = _WORDS[kind]
    order = {"<": "-le", ">": "-be"}[left.order] if name in {"utf-16", "utf-32"} else ""
    return data.decode(name + order, "replace")[:count]


def mat_bytes(variables: Mapping[str, Value], description: str) -> bytes:
    """Return a file that holds arrays of numbers and structs.

    Parameters
    ----------
    variables : mapping of str to arrays or mappings
    description : str
        The text at its beginning, behind the name of the format.
    """
    header = HEADER + b", " + description.encode("latin-1")
    content = b"".join(_written(value, name) for name, value in variables.items())
    return header.ljust(_HEADER_BYTES - 4) + struct.pack("<H2s", 0x0100, b"IM") + content


def _element(kind: int, data: bytes) -> bytes:
    padding = -len(data) % _TAG_BYTES
    return struct.pack("<II", kind, len(data)) + data + b"\0" * padding


def _written(value: Value, name: str) -> bytes:
    """Return the element of one variable or field."""
    if isinstance(value, Mapping):
        names = b"".join(field.encode().ljust(_OF_A_NAME, b"\0") for field in value)
        kind, dims = _STRUCT, (1, 1)
        body = struct.pack("<HHi", 5, 4, _OF_A_NAME) + _element(1, names)  # a small element
        body += b"".join(_written(one, "") for one in value.values())
    else:
        array = np.atleast_2d(np.asarray(value, dtype=np.float64))
        kind, dims = _DOUBLE, array.shape
        body = _element(9, array.astype("<f8").tobytes(order="F"))
    flags = _element(6, struct.pack("<II", kind, 0))
    head = flags + _element(5, struct.pack(f"<{len(dims)}i", *dims)) + _element(1, name.encode())
    return _element(_MATRIX, head + body)
