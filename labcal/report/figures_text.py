"""Formats of numbers in results: signs, missing values, digits of the paper."""

import math

MISSING = "-"


def signed_metres(value: float) -> str:
    """Return a signed error with the paper's five decimals, in metres; zero has no sign."""
    text = f"{value:+.5f}"
    if math.isnan(value):
        return MISSING
    return "0.00000" if float(text) == 0 else text


def percent(value: float) -> str:
    """Return a fraction as a signed percentage, as coarse as the paper's; zero has no sign."""
    if math.isnan(value):
        return MISSING
    text = f"{100 * value:+.1f}".removesuffix(".0")
    return "0%" if float(text) == 0 else f"{text}%"


def millimetres(value: float) -> str:
    """Return a length with three significant digits, and no more than the whole part where that is longer."""
    if math.isnan(value):
        return MISSING
    if value != 0 and abs(value) < 1e-3:  # noqa: PLR2004 - below a micrometre digits run too long
        return f"{value:.1e}"
    digits = 2 - math.floor(math.log10(abs(value))) if value else 0
    return f"{value:.{max(digits, 0)}f}"


def epochs(value: float | int | None) -> str:  # noqa: PYI041 - the checks at run time tell them apart
    """Return a count of training steps, which may be a median between two."""
    if value is None or math.isnan(value):
        return MISSING
    return f"{value:.1f}".removesuffix(".0") if value < 100 else f"{value:.0f}"  # noqa: PLR2004 - halves matter little there


def goal(value: float | None) -> str:
    """Return a training goal as the paper writes it, 1e-7."""
    return MISSING if value is None else f"{value:.0e}".replace("e-0", "e-")
