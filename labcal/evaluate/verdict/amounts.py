"""Amounts in words."""

from math import isfinite


def millimetres(value: float) -> str:
    """Return a length with two significant digits, as in ``0.083 mm``, and whole ones from 100 mm on."""
    if not isfinite(value):
        return "an unknown length"
    return f"{value:.0f} mm" if abs(value) >= 100.0 else f"{float(f'{value:.2g}'):g} mm"  # noqa: PLR2004 -- as said


def pixels(value: float) -> str:
    """Return a length with two significant digits, as in ``0.028 px``."""
    return f"{float(f'{value:.2g}'):g} px" if isfinite(value) else "an unknown number of pixels"


def percent(share: float) -> str:
    """Return a share in whole per cent."""
    return f"{100.0 * share:.0f}%"


def at_distance(distance_mm: float | None) -> str:
    """Return words for a distance from the cameras; none where it is not known."""
    if distance_mm is None or not isfinite(distance_mm):
        return ""
    return f" at {millimetres(distance_mm)} from the cameras"
