"""Views that are held out from a calibration, so that its result can be tested on them."""

from collections.abc import Sequence

import numpy as np

from labcal.errors import InputError

HoldOut = int | Sequence[str]
"""The number of views, evenly spread, or their names."""


def parse_hold_out(text: str, views: Sequence[str]) -> HoldOut:
    """Return the value of ``--hold-out``: names of views, or their number.

    Raises
    ------
    InputError
        It is neither.
    """
    names = text.split(",")
    if all(name in views for name in names):
        return names
    if text.isdecimal():
        return int(text)
    unknown = next(name for name in names if name not in views)
    raise InputError(
        f"--hold-out takes a number of views or their names, but '{unknown}' is neither. There are "
        f"{', '.join(views[:12])}{' ...' if len(views) > 12 else ''}."  # noqa: PLR2004 -- enough to see them
    )


def held_out_views(views: Sequence[str], hold_out: HoldOut) -> tuple[str, ...]:
    """Return the views that are held out, in their order.

    Raises
    ------
    InputError
        There are no such views, or none is left to calibrate from.
    """
    if isinstance(hold_out, int):
        if not 0 <= hold_out < len(views):
            raise InputError(f"{hold_out} of {len(views)} views cannot be held out. Hold out fewer.")
        middles = (np.arange(hold_out) + 0.5) * len(views) / max(hold_out, 1)
        return tuple(views[int(middle)] for middle in middles)
    unknown = [name for name in hold_out if name not in views]
    if unknown:
        raise InputError(f"The view '{unknown[0]}' cannot be held out: it is not among {', '.join(views)}.")
    if set(views) == set(hold_out):
        raise InputError("All views are held out, so that none is left to calibrate from.")
    return tuple(view for view in views if view in hold_out)
