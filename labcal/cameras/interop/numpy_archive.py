"""Arrays in NumPy's archives (``np.savez``), as far as they can be those of cameras: short ones of numbers.

The archive is opened here and not by :func:`numpy.load`, so that sizes are checked before anything is
unpacked; nothing in it is ever unpickled.
"""

import zipfile
import zlib
from io import BytesIO
from pathlib import Path

import numpy as np
from numpy.lib import format as npy

from labcal.errors import InputError

ZIP = "PK\x03\x04"
"""Beginning of every zip file."""
_ENTRY = ".npy"
_MOST_BYTES, _MOST_ENTRIES = 2**16, 200
_MOST_NUMBERS = 100
_NAME_ENDS = 300
"""Characters that the name of the first array is within."""
_BROKEN = (
    ValueError, OSError, EOFError, zipfile.BadZipFile, zlib.error, NotImplementedError, RuntimeError,
    MemoryError, OverflowError, RecursionError, SyntaxError, TypeError, LookupError,
)  # fmt: skip
"""Errors of zipfile and NumPy about damaged archives."""


def is_archive(text: str) -> bool:
    """Tell whether bytes (a character each) are such an archive."""
    return text.startswith(ZIP) and _ENTRY in text[:_NAME_ENDS]


def archived_numbers(data: bytes, path: Path) -> dict[str, object]:
    """Return the arrays of an archive by name: a number or a word, or the list of all numbers row by row.

    Raises
    ------
    InputError
        It is damaged, or two arrays have one name. What is no short array of numbers and no word is left
        out.
    """
    entries: list[zipfile.ZipInfo] = []
    found: dict[str, object] = {}
    try:
        with zipfile.ZipFile(BytesIO(data)) as archive:
            entries = [one for one in archive.infolist() if one.filename.endswith(_ENTRY)]
            for entry in entries[:_MOST_ENTRIES]:
                value = _content(archive, entry)
                if value is not None:
                    found[entry.filename.removesuffix(_ENTRY)] = value
    except _BROKEN as error:
        raise InputError(f"{path} is damaged: {error!s:.100}. Save it again with np.savez.") from error
    names = [entry.filename for entry in entries]
    if len(names) != len(set(names)):
        raise InputError(f"{path} holds two arrays of one name. Save it again with np.savez.")
    return found


def _content(archive: zipfile.ZipFile, entry: zipfile.ZipInfo) -> object:
    """Return the numbers of one array, or its only word; None of what is none of a camera."""
    if entry.file_size > _MOST_BYTES:
        return None
    with archive.open(entry) as file:
        content = BytesIO(file.read(_MOST_BYTES))
    version = npy.read_magic(content)
    if version not in {(1, 0), (2, 0)}:
        return None
    reader = npy.read_array_header_1_0 if version == (1, 0) else npy.read_array_header_2_0
    shape, _, dtype = reader(content)
    count = int(np.prod(np.array(shape, dtype=object)))
    if dtype.kind not in "fiuU" or count > (1 if dtype.kind == "U" else _MOST_NUMBERS):
        return None
    content.seek(0)
    array = npy.read_array(content, allow_pickle=False)
    if array.dtype.kind == "U":
        return "".join(array.ravel().tolist())
    array = array.astype(np.float64)
    return float(array) if array.ndim == 0 else array.ravel().tolist()
