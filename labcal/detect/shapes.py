"""Dots whose outline is another ellipse than the grid's steps make of a dot."""

import numpy as np

from labcal.arrays import Mask
from labcal.detect.lattice import Lattice
from labcal.detect.outlines import Outlines
from labcal.detect.prediction import Predictor
from labcal.detect.seeds import RING_HOLE
from labcal.targets.grid import DotGrid

_ODD, _ODD_PX = 0.2, 0.5
"""Most that a semi-axis is off: in its logarithm, and px."""


def odd_shapes(lattice: Lattice, outlines: Outlines, target: DotGrid) -> Mask:
    """Tell which of a lattice's spots, in their order, have another shape than the others: hidden in part.

    In units of the grid's steps all dots of a board have one shape, wherever it is seen from.
    """
    spots = list(lattice.spots.values())
    found = Predictor(lattice, outlines).shapes_in_steps()
    found[outlines.hole[spots] > RING_HOLE] /= target.ring_size**2
    known = np.isfinite(found[:, 0, 0])
    odd = np.zeros(len(spots), dtype=bool)
    if known.any():
        usual = np.median(found[known], axis=0)
        axes = np.sqrt(np.abs(np.linalg.eigvals(np.linalg.solve(usual, found[known]))))
        minor = np.sqrt(np.linalg.eigvalsh(outlines.shape[spots])[known, 0])
        odd[known] = np.abs(np.log(axes)).max(axis=1) > _ODD + _ODD_PX / minor
    return odd


def without_odd(lattice: Lattice, outlines: Outlines, target: DotGrid) -> Lattice:
    """Return a lattice without the spots of odd shapes, as they are where it skips every other dot."""
    odd = odd_shapes(lattice, outlines, target)
    kept = {node: spot for (node, spot), out in zip(lattice.spots.items(), odd, strict=True) if not out}
    return Lattice(kept, lattice.flattening) if kept else lattice
