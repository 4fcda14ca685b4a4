"""A part of a grid whose dots are all alike, and all numberings under which it fits."""

import numpy as np

from labcal.detect.lattice.dot_shapes import without_deviating_shapes
from labcal.detect.lattice.lattice import Lattice, find_lattices
from labcal.detect.lattice.marks_beside import without_marks_beside
from labcal.detect.lattice.numbering import AnyNumbering
from labcal.detect.lattice.plain import DiagonalNumbering, upright
from labcal.detect.lattice.rings import TURNS, Numbering, pitches_agree
from labcal.detect.lattice.rough_undistortion import NONE
from labcal.detect.lattice.smoothness import is_smooth
from labcal.detect.outlines.outlines import Outlines
from labcal.detect.stage_settings.grid import GridSettings
from labcal.targets.grid import DotGrid, Layout

_FEWEST_LINES = 3


def plain_part(
    outlines: Outlines, target: DotGrid, settings: GridSettings
) -> tuple[Lattice, list[AnyNumbering]]:
    """Return the largest lattice of a picture, and every numbering under which the target holds it.

    No numbering where it has fewer than three lines either way, more than the target, or is not smooth.

    Parameters
    ----------
    outlines : Outlines
        Candidates that lie whole in the picture.
    target : DotGrid
        One without rings.
    settings : GridSettings
    """
    found = find_lattices(outlines, target, NONE, settings)
    if not found:
        return Lattice({}), []
    lattice = without_deviating_shapes(found[0], outlines, target, settings).lattice
    lattice = without_marks_beside(lattice, outlines, target, settings)
    nodes = np.array(list(lattice.spots), dtype=np.int64)
    if len(nodes) < settings.min_dots or np.ptp(nodes, axis=0).min() + 1 < _FEWEST_LINES:
        return lattice, []
    if not is_smooth(lattice, outlines.centre, settings):
        return lattice, []
    if target.layout is Layout.ASYMMETRIC:
        return lattice, _diagonal_numberings(nodes, target)
    tolerance = settings.pitch_ratio_log
    turns = [turn for turn in TURNS if pitches_agree(turn, lattice, outlines, target, tolerance)]
    numberings: list[AnyNumbering] = [
        Numbering(turn, shift)
        for turn in turns
        for shift in _shifts(nodes @ turn.T, np.array([target.cols, target.rows]))
    ]
    return lattice, numberings


def _diagonal_numberings(nodes: np.ndarray, target: DotGrid) -> list[AnyNumbering]:
    """Return the numberings of a part of an asymmetric grid, whose places are in half pitches."""
    size = np.array([2 * target.cols, target.rows])
    return [
        DiagonalNumbering(turn, shift)
        for turn in TURNS
        for shift in _shifts(upright(turn, nodes), size)
        if shift.sum() % 2 == 0
    ]


def _shifts(places: np.ndarray, size: np.ndarray) -> list[np.ndarray]:
    """Return the shifts after which all places are from (0, 0) on and below a size."""
    low, high = places.min(axis=0), places.max(axis=0)
    return [
        np.array([right, up])
        for right in range(-int(low[0]), int(size[0] - high[0]))
        for up in range(-int(low[1]), int(size[1] - high[1]))
    ]
