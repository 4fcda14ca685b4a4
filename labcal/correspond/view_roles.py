"""Views that are held out from a calibration, so that its result can be tested on them."""

from collections.abc import Sequence
from operator import index
from pathlib import Path

import numpy as np

from labcal.arguments import texts, wrong_type
from labcal.correspond.detections import Detections
from labcal.errors import InputError, UnknownNameError
from labcal.shoot.dataset import is_shoot, open_shoot
from labcal.shoot.manifest import Role
from labcal.wording import listed

HoldOut = int | str | Sequence[str]
"""Number of views, spread evenly, or their names; also as text, ``"2"``, ``"a,b"`` or ``"none"``."""
NONE = "none"
"""No view is held out, the test views of a shoot neither."""


def parse_hold_out(text: str, views: Sequence[str]) -> int | list[str]:
    """Return what a text says: names of views between commas, or how many.

    Raises
    ------
    UnknownNameError
        It is neither.
    """
    names = [name.strip() for name in text.split(",")]
    if all(name in views for name in names):
        return names
    if text.strip().isdecimal():
        return int(text)
    unknown = next(name for name in names if name not in views)
    raise UnknownNameError("view to hold out", unknown, views)


def checked_hold_out(hold_out: object) -> HoldOut:
    """Return what is to be held out as a number, as text, or as names.

    Raises
    ------
    InputTypeError
        It is none of them.
    """
    if isinstance(hold_out, str):
        return hold_out
    if isinstance(hold_out, bool | np.bool_):
        raise wrong_type(hold_out, "a number of views, or names of views", "hold_out")
    return index(hold_out) if hasattr(hold_out, "__index__") else texts(hold_out, "hold_out")


def holds_none(hold_out: HoldOut, views: Sequence[str]) -> bool:
    """Tell whether no view is to be held out, those neither that a shoot keeps to test on."""
    return isinstance(hold_out, str) and hold_out.strip() == NONE and NONE not in views


def held_out_views(views: Sequence[str], hold_out: HoldOut) -> tuple[str, ...]:
    """Return the views that are held out, in their order.

    Raises
    ------
    UnknownNameError, InputError, InputTypeError
        There are no such views, or none is left to calibrate from.
    """
    hold_out = checked_hold_out(hold_out)
    if isinstance(hold_out, str):
        if holds_none(hold_out, views):
            return ()
        hold_out = parse_hold_out(hold_out, views)
    if isinstance(hold_out, int):
        if hold_out < 0:
            raise InputError(f"`hold_out` is a number of views, 0 or more, but {hold_out} was given.")
        if hold_out and hold_out >= len(views):
            raise InputError(f"{hold_out} of {len(views)} views cannot be held out. Hold out fewer.")
        middles = (np.arange(hold_out) + 0.5) * len(views) / max(hold_out, 1)
        return tuple(views[int(middle)] for middle in middles)
    unknown = [name for name in hold_out if name not in views]
    if unknown:
        raise UnknownNameError("view to hold out", unknown[0], views)
    if hold_out and set(views) == set(hold_out):
        raise InputError("All views are held out, so that none is left to calibrate from.")
    return tuple(view for view in views if view in hold_out)


def warning_of_test_views(detections: Detections) -> str | None:
    """Return a warning where a table is of a shoot that has views to test on, and these are in it, too."""
    home = Path(str(detections.image[0])).parent.parent if len(detections) else Path()
    if not is_shoot(home):
        return None
    try:
        views = open_shoot(home).views(Role.TEST)
    except InputError:  # nothing is wanted of that shoot
        return None
    tested = [view.name for view in views if view.name in detections.views]
    if not tested:
        return None
    return (
        f"the views {listed(tested)} enter, which the shoot {home} keeps to test on. To leave them out, give "
        f"{home} itself, with this table as its `detections`"
    )
