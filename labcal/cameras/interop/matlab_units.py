"""``WorldUnits`` of MATLAB's camera parameters: the unit in which a board was described."""

from collections.abc import Mapping
from pathlib import Path

from labcal.cameras.interop.exchange import Unit
from labcal.cameras.interop.length_units import unit_in_words
from labcal.cameras.interop.mat_file import Value

_FIELD = "WorldUnits"


def stated_unit(
    pair: Mapping[str, Value], given: Unit | None, path: Path
) -> tuple[Unit | None, float, tuple[str, ...]]:
    """Return what a pair's ``WorldUnits`` make of its lengths.

    Millimetres are MATLAB's default, which stands there also where a board was described in metres: they say
    nothing.

    Parameters
    ----------
    pair : mapping
        Fields of the struct.
    given : Unit, optional
        What a user states.
    path : Path
        The file, for messages.

    Returns
    -------
    Unit or None
        Of the lengths once they are multiplied; None where nothing is stated.
    float
        The factor.
    tuple of str
        A note where that is not 1.

    Raises
    ------
    InputError
        The words are of no unit of length, those of pair and cameras differ, or the user states another one.
    """
    parts = [pair, *(one for one in pair.values() if isinstance(one, Mapping))]
    words = {word.strip() for part in parts if isinstance(word := part.get(_FIELD), str) and word.strip()}
    unit, scale, notes = unit_in_words(words, _FIELD, None, path)
    if unit is Unit.MILLIMETRES and scale == 1.0:
        return None, 1.0, ()
    unit_in_words(words, _FIELD, given, path)  # raises where they contradict each other
    return unit, scale, notes
