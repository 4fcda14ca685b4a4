"""Seeds of a grid: spots with neighbours one step along both axes."""

from dataclasses import dataclass

import numpy as np

from labcal.detect.lattice.crosses import CrossLimits, cross_at
from labcal.detect.outlines.outlines import Outlines
from labcal.detect.stage_settings.grid import GridSettings
from labcal.targets.grid import DotGrid, Layout

_FLAT_ROWS = 3
"""Rows of an asymmetric grid of which a cross has corners within its own row alone."""
_STEPS = ((0, 0), (1, 0), (0, 1), (-1, 0), (0, -1), (1, 1), (1, -1), (-1, 1), (-1, -1))


@dataclass(frozen=True)
class Seed:
    """A spot with those around it, by their steps along both axes, and how badly the cross fits."""

    spots: dict[tuple[int, int], int]
    misfit: float

    @property
    def middle(self) -> int:
        """The spot that the seed is about."""
        return self.spots[0, 0]


def seed_at(
    i: int, outlines: Outlines, target: DotGrid, radius: np.ndarray, settings: GridSettings
) -> Seed | None:
    """Return the smallest cross around spot i whose arms are square to each other on the board.

    The dots' own ellipses show how the board is foreshortened there, so the angle and the ratio of the steps
    are known without the pose. A step is measured by the geometric mean of the ellipses at its ends, which
    is right for any perspective along the step.

    Parameters
    ----------
    i : int
    outlines : Outlines
    target : DotGrid
    radius : ndarray, shape (n,)
        Of the outlines, px: a cross is made of spots about as large as spot i.
    settings : GridSettings
    """
    expected = abs(float(np.log(target.cell_mm[0] / target.cell_mm[1])))
    # One corner of four may be missing; of an asymmetric grid with three rows the two across them are.
    corners = 2 if target.layout is Layout.ASYMMETRIC and target.rows <= _FLAT_ROWS else 3
    spots, misfit = cross_at(
        i,
        (outlines.centre, outlines.shape, outlines.hole, radius),
        (expected, target.ring_size, corners),
        settings.limits(CrossLimits),
        np.array(_STEPS),
    )
    if spots[0] < 0:
        return None
    found = zip(_STEPS, spots.tolist(), strict=True)
    return Seed({step: spot for step, spot in found if spot >= 0}, misfit)
