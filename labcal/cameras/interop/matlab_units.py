"""``WorldUnits`` of MATLAB's camera parameters: the unit in which a board was described."""

from collections.abc import Mapping
from pathlib import Path

from labcal.cameras.interop.exchange import Unit
from labcal.cameras.interop.mat_file import Value
from labcal.errors import InputError

_FIELD = "WorldUnits"
_MM = {
    "mm": 1.0, "millimeters": 1.0, "millimeter": 1.0, "millimetres": 1.0, "cm": 10.0, "centimeters": 10.0,
    "centimeter": 10.0, "centimetres": 10.0, "m": 1000.0, "meters": 1000.0, "meter": 1000.0, "metres": 1000.0,
    "in": 25.4, "inch": 25.4, "inches": 25.4, "ft": 304.8, "feet": 304.8, "um": 1e-3, "micrometers": 1e-3,
}  # fmt: skip


def stated_unit(pair: Mapping[str, Value], path: Path) -> tuple[Unit | None, float, tuple[str, ...]]:
    """Return what a pair's ``WorldUnits`` make of its lengths.

    Millimetres are MATLAB's default, which stands there also where a board was described in metres: they say
    nothing.

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
        The words are of no unit of length, or those of pair and cameras differ.
    """
    parts = [pair, *(one for one in pair.values() if isinstance(one, Mapping))]
    words = {word.strip() for part in parts if isinstance(word := part.get(_FIELD), str) and word.strip()}
    known = {_MM.get(word.lower()) for word in words}
    if None in known or len(known) > 1:
        raise InputError(
            f"{path}: {_FIELD} should be one unit of length, as mm or m, but is "
            f"{' and '.join(repr(word)[:40] for word in sorted(words))}. Set it in MATLAB, and save again."
        )
    scale = next(iter(known), None)
    if scale in (None, Unit.MILLIMETRES.mm):
        return None, 1.0, ()
    if scale == Unit.METRES.mm:
        return Unit.METRES, 1.0, ()
    note = f"{path}: {_FIELD} is '{min(words)}': lengths are multiplied by {scale:g} to be in mm."
    return Unit.MILLIMETRES, float(scale or 1.0), (note,)
