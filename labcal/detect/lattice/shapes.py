"""Dots whose outline is another ellipse than the grid's steps make of a dot."""

import numpy as np

from labcal.arrays import Mask
from labcal.detect.lattice.lattice import Lattice
from labcal.detect.lattice.prediction import Predictor
from labcal.detect.lattice.seeds import RING_HOLE
from labcal.detect.outlines.outlines import Outlines
from labcal.geometry.two_by_two import eigenvalues, inverses
from labcal.targets.grid import DotGrid

_ODD, _ODD_AT_RIM, _VERY_ODD = 0.2, 0.3, 0.45
"""Most that a semi-axis is off in its logarithm: amid other dots; at the rim, where steps are less sure; and
from where on a spot is no dot of the grid at all."""
_ODD_PX = 0.5
"""What pixels do to a semi-axis."""
_AMID = 12
"""Neighbours of a dot that is amid others."""


def odd_shapes(predictor: Predictor, outlines: Outlines, target: DotGrid) -> Mask:
    """Tell which of a lattice's spots, in their order, have another shape than the others: hidden in part.

    In units of the grid's steps all dots of a board have one shape, wherever it is seen from.

    Parameters
    ----------
    predictor : Predictor
        Of the lattice.
    outlines : Outlines
        The same spots as the predictor's, of whatever shapes are to be judged.
    target : DotGrid
    """
    limit = np.where(predictor.neighbours() >= _AMID, _ODD, _ODD_AT_RIM)
    return _off(predictor, outlines, target) > limit


def without_odd(lattice: Lattice, outlines: Outlines, target: DotGrid) -> Lattice:
    """Return a lattice without spots of very odd shapes, as they are where it skips every other dot."""
    odd = _off(Predictor(lattice, outlines), outlines, target) > _VERY_ODD
    kept = {node: spot for (node, spot), out in zip(lattice.spots.items(), odd, strict=True) if not out}
    return Lattice(kept, lattice.flattening) if kept else lattice


def _off(predictor: Predictor, outlines: Outlines, target: DotGrid) -> np.ndarray:
    """Return by how much a semi-axis is off, in its logarithm, less what pixels do; 0 where none can tell."""
    spots = list(predictor.lattice.spots.values())
    found = predictor.shapes_in_steps(outlines)
    found[outlines.hole[spots] > RING_HOLE] /= target.ring_size**2
    known = np.isfinite(found[:, 0, 0])
    off = np.zeros(len(spots))
    if known.any():
        usual = np.median(found[known], axis=0)
        axes = np.sqrt(np.abs(eigenvalues(inverses(usual) @ found[known])))
        minor = np.sqrt(eigenvalues(outlines.shape[spots])[known, 0])
        off[known] = np.abs(np.log(axes)).max(axis=1) - _ODD_PX / minor
    return off
