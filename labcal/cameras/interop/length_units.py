"""Units of length that files of cameras state in words."""

from collections.abc import Collection
from pathlib import Path

from labcal.cameras.interop.exchange import Unit
from labcal.errors import InputError

_MM = {
    "mm": 1.0, "millimeters": 1.0, "millimeter": 1.0, "millimetres": 1.0, "millimetre": 1.0, "cm": 10.0,
    "centimeters": 10.0, "centimeter": 10.0, "centimetres": 10.0, "centimetre": 10.0, "m": 1000.0,
    "meters": 1000.0, "meter": 1000.0, "metres": 1000.0, "metre": 1000.0, "in": 25.4, "inch": 25.4,
    "inches": 25.4, "ft": 304.8, "feet": 304.8, "um": 1e-3, "micrometers": 1e-3, "micrometres": 1e-3,
}  # fmt: skip
_NAMED = "mm, cm, m, um, inches or feet"


def is_unit_of_length(word: object) -> bool:
    """Tell whether a word is a unit of length."""
    return isinstance(word, str) and word.strip().lower() in _MM


def unit_in_words(
    words: Collection[str], what: str, given: Unit | None, path: Path
) -> tuple[Unit | None, float, tuple[str, ...]]:
    """Return the unit of lengths, by what a file calls it.

    Parameters
    ----------
    words : collection of str
        All that the file calls it; none where it states nothing.
    what : str
        Where they stand, for messages.
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
        The words are of no unit of length, or of several, or the user states another one.
    """
    stated = sorted({word.strip() for word in words})
    if not stated:
        return None, 1.0, ()
    known = {_MM.get(word.lower()) for word in stated}
    if None in known or len(known) > 1:
        raise InputError(
            f"{path}: {what} should be one unit of length, {_NAMED}, but is "
            f"{' and '.join(repr(word)[:40] for word in stated)}. Correct it, and save the file again."
        )
    mm = float(next(iter(known)) or 1.0)
    if given is not None and given.mm != mm:
        raise InputError(
            f"The files state themselves that lengths are in {stated[0]} ({what} in {path}), but "
            f"`unit='{given.value}'` states otherwise. Leave that out."
        )
    for unit in Unit:
        if mm == unit.mm:
            return unit, 1.0, ()
    note = f"{path}: {what} is '{stated[0]}': lengths are multiplied by {mm:g} to be in mm."
    return Unit.MILLIMETRES, mm, (note,)
