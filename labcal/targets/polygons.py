"""The print of a target as polygons: outlines whose curves have become many short sides."""

import numpy as np
from jaxtyping import Float64
from matplotlib.path import Path as Outline
from matplotlib.transforms import Affine2D

from labcal.targets.shapes import printed_outlines
from labcal.targets.target import PrintableTarget

_FINER = 1000.0
"""A curve is made flat to a quarter of a unit: of a thousandth of a mm here."""


def print_polygons(target: PrintableTarget) -> list[Float64[np.ndarray, "corners 2"]]:
    """Return the outlines of all that is printed as closed polygons, mm in the target's frame.

    Parameters
    ----------
    target : PrintableTarget

    Returns
    -------
    list of ndarray, shape (corners, 2)
        The last corner of each is its first one.

    Raises
    ------
    InputError
        The kind is a user's, and its outlines are none.
    """
    return as_polygons(printed_outlines(target))


def as_polygons(outlines: Outline) -> list[Float64[np.ndarray, "corners 2"]]:
    """Return outlines in mm as closed polygons, the last corner of each its first one."""
    larger = outlines.transformed(Affine2D().scale(_FINER))
    larger.should_simplify = False
    return [np.asarray(polygon, dtype=np.float64) / _FINER for polygon in larger.to_polygons()]
