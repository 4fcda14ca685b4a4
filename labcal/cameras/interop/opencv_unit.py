"""The unit of lengths in files of OpenCV: what they state, and what the squares of the board tell of it."""

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import replace

import numpy as np

from labcal.cameras.interop.exchange import ReadRig, Unit
from labcal.cameras.interop.length_units import unit_in_words
from labcal.cameras.interop.numbers_text import is_number
from labcal.cameras.interop.opencv_names import MATRIX, SIDES, named_so, side_keys
from labcal.cameras.interop.opencv_pose import TRANSLATION
from labcal.cameras.interop.opencv_storage import Storage
from labcal.cameras.interop.placement import scaled_rig
from labcal.cameras.rig import Rig
from labcal.errors import InputError

_UNIT = (
    "unit", "units", "length_unit", "length_units", "unit_of_length", "units_of_length", "world_unit",
    "world_units", "translation_unit", "translation_units", "distance_unit", "distance_units", "T_unit",
    "baseline_unit", "square_unit", "square_size_unit",
)  # fmt: skip
_SQUARE = ("square_size", "square_length", "size_of_square", "square_width", "square_side", "square")
_SMALLEST_MM = 1.0
"""Side of a square that a board has and a camera resolves; smaller ones are in metres, or in other units."""
_OF_SIDES = tuple(key for sides in SIDES for side in sides for key in side_keys(_UNIT, side))
_OF_NO_LENGTH = {"px", "pixel", "pixels", "deg", "degree", "degrees", "rad", "radian", "radians"}


def in_stated_unit(read: ReadRig, stores: Sequence[Storage], given: Unit | None) -> ReadRig:
    """Return what was read of files in the unit that they state.

    Parameters
    ----------
    read : ReadRig
        With lengths as they stand in the files.
    stores : sequence of Storage
        All files.
    given : Unit, optional
        What a user states.

    Returns
    -------
    ReadRig
        Lengths in mm or in m, as its `unit` states, or in a unit that nobody states.

    Raises
    ------
    InputError
        A file states what is no unit of length, several units are stated, or another one than the user does;
        or nobody states one, and the squares of the board are too small to be in mm.
    """
    found = [(word, storage) for storage in stores for word in _words(storage)]
    if not found:
        if given is None and _is_placed(read.rig):
            _require_likely_squares(stores)
        return read
    words = [word for word, _ in found]
    unit, scale, notes = unit_in_words(words, "the unit", given, found[-1][1].path)
    return replace(read, rig=scaled_rig(read.rig, scale), unit=unit, notes=(*read.notes, *notes))


def _is_placed(rig: Rig) -> bool:
    """Tell whether a rig has any length."""
    return any(np.any(np.array(record.T_cam_world)[:3, 3]) for record in rig.cameras.values())


def _words(storage: Storage) -> Iterator[str]:
    """Return what a file calls the unit of its lengths; numbers are returned as they are written."""
    keys = [key for key in storage.content if isinstance(key, str)]
    for key in named_so((*_UNIT, *_OF_SIDES), keys):
        value = storage.content[key]
        known = isinstance(value, (str, int, float)) and str(value).strip().lower() not in _OF_NO_LENGTH
        if known and _is_of_the_pose(key, storage.content, keys):
            yield str(value)


def _is_of_the_pose(key: str, content: Mapping[str, object], keys: Sequence[str]) -> bool:
    """Tell whether a unit is that of the whole file or of a pose or camera in it, not of a sensor, say."""
    holders = [one.removesuffix(f"_{key}") for one in keys if one.endswith(f"_{key}")]
    within = [one for one in holders if content[f"{one}_{key}"] == content[key]]
    beside = [f"{one}_{name}" for one in within for name in (*TRANSLATION, *MATRIX)]
    return not within or bool(named_so(beside, keys))


def _require_likely_squares(stores: Sequence[Storage]) -> None:
    """Raise where the squares of the board would be smaller than any that a camera resolves.

    Raises
    ------
    InputError
        They would.
    """
    for storage in stores:
        for key in storage.there(_SQUARE):
            word = str(storage.content[key])
            side = float(word) if is_number(word) else _SMALLEST_MM
            if 0.0 < side < _SMALLEST_MM:
                raise InputError(
                    f"{storage.path} states squares of {side:g} ({key}), which are hardly mm, as lengths in "
                    "most files of OpenCV are. State the unit of its lengths: `unit='m'` or `unit='mm'`."
                )
