"""Scales of prints as people state them: measured lengths of the ruler over its nominal length."""

import re

from pydantic import BaseModel, ValidationError

from labcal.errors import InputError, InputTypeError
from labcal.targets.catalogue import AnyTarget
from labcal.targets.scaled_print import LEAST_SCALE, MOST_SCALE, ScaledPrint
from labcal.targets.target import PrintableTarget
from labcal.wording import clipped, shown

AnyPrintScale = str | float | tuple[float, float]
"""``"99.8/100"``, ``"99.8/100,100.1/100"`` (along x, along y), or the quotient itself, or two."""

_LENGTH = r"([0-9]{1,6}(?:\.[0-9]{1,9})?)"
_STATED = re.compile(rf"{_LENGTH}/{_LENGTH}")


def print_scale(given: AnyPrintScale) -> tuple[float, float]:
    """Return the scale of a print along x and y.

    Parameters
    ----------
    given : str, float or tuple of float
        Measured over nominal length: ``"99.8/100"``; along x and along y where they differ:
        ``"99.8/100,100.1/100"``; or the quotients as numbers.

    Raises
    ------
    InputError
        It is no such quotient, or no print has this scale.
    InputTypeError
        It is neither text nor a number nor two of them.
    """
    if isinstance(given, str):
        parts = [_STATED.fullmatch(part.strip()) for part in given.split(",")]
        if len(parts) > 2 or not all(part is not None and float(part[2]) > 0 for part in parts):  # noqa: PLR2004 -- x, y
            raise InputError(
                f"The scale of a print is MEASURED/NOMINAL, as in `print_scale='99.8/100'` for a ruler of "
                f"100 mm that measures 99.8 mm, or two of them for x and y ('99.8/100,100.1/100'), but "
                f"{clipped(given)!r} was given."
            )
        scales = [float(part[1]) / float(part[2]) for part in parts if part is not None]
    elif isinstance(given, int | float) and not isinstance(given, bool):
        scales = [float(given)]
    elif isinstance(given, tuple | list) and len(given) == 2:  # noqa: PLR2004 -- x, y
        scales = [float(part) for part in given]
    else:
        raise InputTypeError(f"The scale of a print is text, a number, or two, but {shown(given)} was given.")
    if not all(LEAST_SCALE <= scale <= MOST_SCALE for scale in scales):
        raise InputError(
            f"The scale of a print is between {LEAST_SCALE:g} and {MOST_SCALE:g}, but is "
            f"{', '.join(f'{scale:.6g}' for scale in scales)}. State measured over nominal length."
        )
    return scales[0], scales[-1]


def printed_to_scale(target: AnyTarget, scale: AnyPrintScale) -> AnyTarget:
    """Return a target as a print has it whose ruler was measured.

    Parameters
    ----------
    target : AnyTarget
        As designed.
    scale : str, float or tuple of float
        As of :func:`print_scale`.

    Returns
    -------
    AnyTarget
        The same with the key `print_scale`: places and sizes of dots are those of the print.

    Raises
    ------
    InputError
        Its scale is stated already; it is of a kind of the user's without this key; or as of
        :func:`print_scale`.
    """
    wanted = print_scale(scale)
    if not (isinstance(target, ScaledPrint) and isinstance(target, BaseModel)):
        raise InputError(
            f"'{clipped(target.name)}' is of a kind of your own, which has no key 'print_scale'. Give its "
            "description the lengths that the print has."
        )
    if target.print_scale is not None:
        x, y = target.print_scale
        raise InputError(
            f"The scale of the print of '{clipped(target.name)}' is stated already: {x:.6g} along x, {y:.6g} "
            "along y. Leave `print_scale` out; to correct it, change it where it stands."
        )
    try:
        return type(target).model_validate({**target.model_dump(), "print_scale": wanted})
    except ValidationError as error:
        raise InputError(f"The target cannot have this scale: {error.errors()[0]['msg']}.") from error


def as_designed(target: PrintableTarget) -> PrintableTarget:
    """Return a target without the scale of a print of it: the design, in which places are as declared."""
    if isinstance(target, ScaledPrint) and isinstance(target, BaseModel) and target.print_scale is not None:
        return target.model_copy(update={"print_scale": None})
    return target


def as_printed(target: AnyTarget, scale: AnyPrintScale | None) -> AnyTarget:
    """Return a target as :func:`printed_to_scale` does where a scale is given; else as it is."""
    return target if scale is None else printed_to_scale(target, scale)
