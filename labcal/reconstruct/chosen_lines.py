"""Lines of the points that a user means: by their numbers, or by the names of named points."""

from collections.abc import Sequence

import numpy as np
from jaxtyping import Int64

from labcal.arguments import whole_number, wrong_type
from labcal.arrays import AnyArray, lines_array
from labcal.correspond.named_points import NamedPoints
from labcal.correspond.points import Points
from labcal.errors import InputError, UnknownNameError
from labcal.wording import listed

OnePoint = int | str | tuple[str, str]
"""A point: the number of its line, its name, or its view and name."""
_PAIR = 2


def line_of(points: Points | NamedPoints, given: object, name: str) -> int:
    """Return the line of one point.

    Parameters
    ----------
    points : Points or NamedPoints
    given : int, str or (str, str)
        The number of a line; of named points also a name, or a view and a name.
    name : str
        Of the argument, for messages.

    Raises
    ------
    InputError, InputTypeError
        There is no such line or point, or several views have a point of this name.
    """
    if isinstance(given, str):
        return _named(points, None, given, name)
    if isinstance(given, tuple | list) and len(given) == _PAIR and all(isinstance(one, str) for one in given):
        return _named(points, str(given[0]), str(given[1]), name)
    if not hasattr(given, "__index__"):
        raise wrong_type(given, "the number of a line, a name, or a view and a name", name)
    number = whole_number(given, name, -len(points))
    return int(lines_array([number], len(points), name)[0]) % len(points)


def lines_of(points: Points | NamedPoints, given: AnyArray, name: str) -> Int64[np.ndarray, " k"]:
    """Return the lines of several points.

    Parameters
    ----------
    points : Points or NamedPoints
    given : array_like of int or bool, or sequence of str or (str, str)
        Numbers of lines or a mask; of named points also names, or views and names.
    name : str
        Of the argument, for messages.

    Raises
    ------
    InputError, InputTypeError
        As of :func:`line_of`, or of :func:`~labcal.arrays.lines_array`.
    """
    if isinstance(given, str):
        return np.array([line_of(points, given, name)])
    if isinstance(given, Sequence | np.ndarray) and len(given) and isinstance(given[0], str | tuple | list):
        return np.array([line_of(points, one, name) for one in given])
    return np.asarray(np.arange(len(points))[lines_array(given, len(points), name)])


def _named(points: Points | NamedPoints, view: str | None, point: str, argument: str) -> int:
    """Return the line of a named point, of the only view that has it if none is named."""
    if not isinstance(points, NamedPoints):
        raise InputError(f"`{argument}` names a point, but dots have no names. Give the number of its line.")
    if view is not None and view not in points.view:
        raise UnknownNameError("view in the points", view, dict.fromkeys(points.view.tolist()))
    there = points.name == point
    if not there.any():
        raise UnknownNameError("point", point, dict.fromkeys(points.name.tolist()))
    lines = np.flatnonzero(there if view is None else there & (points.view == view))
    if not len(lines):
        views = listed(dict.fromkeys(points.view[there].tolist()))
        raise InputError(f"View '{view}' has no point '{point}', but these views have: {views}.")
    if len(lines) > 1:
        several = dict.fromkeys(points.view[lines].tolist())
        raise InputError(
            f"Point '{point}' is in {len(several)} views ({listed(several)}). Give `{argument}` as "
            f"('VIEW', '{point}')."
        )
    return int(lines[0])
