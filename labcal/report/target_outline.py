"""The outline of a board, for figures in space."""

import numpy as np

from labcal.arrays import Vectors3
from labcal.targets.target import Target


def target_outline(target: Target) -> Vectors3:
    """Return the corners of the board as a closed line, with a mark in the corner of dot (0, 0).

    Returns
    -------
    ndarray, shape (n, 3)
        In the target's frame, mm.
    """
    left, bottom, right, top = target.extent_mm
    cut = 0.12 * min(right - left, top - bottom)
    corners = [
        (left + cut, bottom), (right, bottom), (right, top), (left, top), (left, bottom + cut),
        (left + cut, bottom), (left, bottom), (left, bottom + cut),
    ]  # fmt: skip
    return np.array([(x, y, 0.0) for x, y in corners])
