"""A few of the many levels of a factor, where there is no room for all."""

from collections.abc import Sequence
from typing import TypeVar

import numpy as np

Level = TypeVar("Level", int, float)


def spread_levels(levels: Sequence[Level], most: int) -> list[Level]:
    """Return at most so many levels, sorted and evenly spread; the least and the greatest are among them.

    Parameters
    ----------
    levels : sequence of numbers
        In any order, each as often as it likes.
    most : int
        At least 1; of one level the least is taken.
    """
    every = sorted(set(levels))
    if len(every) <= most:
        return every
    return [every[place] for place in np.linspace(0, len(every) - 1, most).round().astype(int)]
