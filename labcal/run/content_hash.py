"""A hash of the content of a value, the same in every process and on every machine."""

import dataclasses
import hashlib
import math
import struct
from collections.abc import Mapping
from enum import Enum
from functools import partial
from pathlib import PurePath
from types import BuiltinFunctionType, FunctionType

import numpy as np
from pydantic import BaseModel

from labcal.errors import InputTypeError
from labcal.run.code_version import module_digest


def content_hash(value: object) -> str:
    """Return the SHA-256 of a value's content, as hexadecimal digits.

    Equal content gives equal digests, whatever its identity, the order of a mapping's keys or of a set's
    members, and the memory layout of an array. NaN equals NaN, an int differs from a float. A dataclass or a
    pydantic model counts with the name of its class and its fields (those that take part in comparisons). A
    function or a class counts with its name; outside of labcal, also with the content of its module's file.

    Parameters
    ----------
    value : object
        Made of None, bool, int, float, str, bytes, enums, paths, NumPy arrays and scalars, dataclasses,
        pydantic models, functions and classes of the module level, and tuples, lists, sets and mappings.

    Raises
    ------
    InputTypeError
        Something in it has another type.
    """
    return _digest(value, "the value").hex()


def _digest(value: object, where: str) -> bytes:
    """Return the digest of a value: of its kind and its pieces, each after its length."""
    kind, pieces = _leaf(value) or _composite(value, where)
    digest = hashlib.sha256(f"{kind}:{len(pieces)};".encode())
    for piece in pieces:
        digest.update(f"{len(piece)};".encode())
        digest.update(piece)
    return digest.digest()


def _leaf(value: object) -> tuple[str, list[bytes]] | None:
    """Return the kind and the bytes of a plain value; None for any other."""
    pieces: list[bytes] | None = None
    match value:
        case Enum():
            pieces = [b"enum", _name(type(value)), value.name.encode()]
        case None | bool():
            pieces = [repr(value).encode()]
        case int():
            pieces = [b"int", str(value).encode()]
        case float():
            pieces = [b"float", struct.pack("<d", math.nan if math.isnan(value) else value)]
        case str():
            pieces = [b"str", value.encode("utf-8", "surrogatepass")]
        case bytes():
            pieces = [b"bytes", value]
        case PurePath():
            pieces = [b"path", value.as_posix().encode("utf-8", "surrogateescape")]
    return None if pieces is None else ("leaf", pieces)


def _composite(value: object, where: str) -> tuple[str, list[bytes]]:
    """Return the kind of an array, a collection, an object or code, and its pieces."""
    match value:
        case np.ndarray() | np.generic():
            found = "array", _array_pieces(np.asarray(value), where)
        case list() | tuple():
            found = "sequence", [_digest(item, f"{where}[{number}]") for number, item in enumerate(value)]
        case set() | frozenset():
            found = "set", sorted(_digest(item, f"an item of {where}") for item in value)
        case Mapping():
            items = value.items()
            pairs = [
                _digest(key, f"a key of {where}") + _digest(item, f"{where}[{key!r}]") for key, item in items
            ]
            found = "mapping", sorted(pairs)
        case partial():
            found = "partial", [_digest((value.func, value.args, value.keywords), where)]
        case FunctionType() | BuiltinFunctionType() | type():
            found = "code", [_name(value)]
        case _:
            fields = _fields(value, where).items()
            pieces = [name.encode() + _digest(item, f"{where}.{name}") for name, item in fields]
            found = "object", [_name(type(value)), *pieces]
    return found


def _array_pieces(array: np.ndarray, where: str) -> list[bytes]:
    """Return the type, the shape and the data of an array, in one byte order."""
    if array.dtype.hasobject:
        raise _unknown(array, where)
    little = array.astype(array.dtype.newbyteorder("<"), copy=False)
    return [little.dtype.str.encode(), repr(array.shape).encode(), little.tobytes()]


def _fields(value: object, where: str) -> dict[str, object]:
    """Return the fields of a pydantic model or a dataclass by name."""
    if isinstance(value, BaseModel):
        return {name: getattr(value, name) for name in type(value).model_fields}
    if dataclasses.is_dataclass(value):
        return {
            field.name: getattr(value, field.name) for field in dataclasses.fields(value) if field.compare
        }
    raise _unknown(value, where)


def _name(code: type | FunctionType | BuiltinFunctionType) -> bytes:
    """Return the full name of a class or function, with the digest of its file where that is not labcal's."""
    module, name = code.__module__ or "", code.__qualname__
    if name.endswith("<lambda>"):
        raise InputTypeError(
            f"A lambda of the module '{module}' has no name. Define a function that has one."
        )
    if module == "labcal" or module.startswith("labcal.") or module == "builtins":
        return f"{module}:{name}".encode()
    return f"{module}:{name}:{module_digest(module)}".encode()


def _unknown(value: object, where: str) -> InputTypeError:
    return InputTypeError(
        f"{where} is of type {type(value).__name__}, whose content has no hash. Use plain values, arrays "
        "without objects, dataclasses or pydantic models."
    )
