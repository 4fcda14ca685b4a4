"""Dots that the first look missed, looked for where their neighbours say they are."""

import numpy as np

from labcal.detect.grey import GreyPicture
from labcal.detect.lattice import Lattice, Node, typical_outline
from labcal.detect.outlines import Outlines, mean_radius, trace_from
from labcal.detect.rings import Numbering
from labcal.targets.grid import DotGrid

_MISS = 0.12  # of a step between an outline and where it is expected
_SIZE_TOLERANCE = 0.35  # in the logarithm of the radius
_ROUNDS = 20  # each goes a node farther


def with_missed(
    grey: GreyPicture, lattice: Lattice, numbering: Numbering, outlines: Outlines, target: DotGrid
) -> tuple[Lattice, Outlines]:
    """Return the lattice with further dots of the declared grid, and all outlines.

    Parameters
    ----------
    grey : ndarray, shape (h, w)
    lattice : Lattice
    numbering : Numbering
        Of the lattice.
    outlines : Outlines
        To which the lattice's spots refer; further ones are added at the end.
    target : DotGrid
    """
    tried: set[Node] = set()
    for _ in range(_ROUNDS):
        nodes = [node for node in _beside(lattice, numbering, target) if node not in tried]
        expected = [(node, found) for node in nodes if (found := lattice.predict(node, outlines.centre))]
        tried.update(nodes)
        if not expected:
            break
        centre = np.array([found.position for _, found in expected])
        shape = np.array([typical_outline(lattice, node, outlines) for node, _ in expected])
        inside = _inside(centre, shape, grey.shape)
        expected = [pair for pair, keep in zip(expected, inside, strict=True) if keep]
        seen, which = trace_from(grey, centre[inside], shape[inside], target)
        size = np.abs(np.log(seen.radius / mean_radius(shape[inside][which])))
        known = outlines.centre[list(lattice.spots.values())]
        spots = dict(lattice.spots)
        for number, pick in enumerate(which):
            node, found = expected[pick]
            apart = np.linalg.norm(known - seen.centre[number], axis=1).min() > seen.radius[number]
            if size[number] < _SIZE_TOLERANCE and apart and found.miss(seen.centre[number]) < _MISS:
                spots[node] = len(outlines.centre)
                outlines = outlines.joined(seen.select(np.array([number])))
        if len(spots) == len(lattice):
            break
        lattice = Lattice(spots)
    return lattice, outlines


def _beside(lattice: Lattice, numbering: Numbering, target: DotGrid) -> list[Node]:
    """Return the empty nodes of the declared grid next to the lattice's."""
    span = (-1, 0, 1)
    beside = {(a + i, b + j) for a, b in lattice.spots for i in span for j in span} - lattice.spots.keys()
    within = []
    for node in sorted(beside):
        col, row = numbering.index(node)
        if 0 <= col < target.cols and 0 <= row < target.rows:
            within.append(node)
    return within


def _inside(centre: np.ndarray, shape: np.ndarray, size: tuple[int, ...]) -> np.ndarray:
    """Tell which outlines lie in the frame as a whole."""
    extent = np.sqrt(np.diagonal(shape, axis1=1, axis2=2))
    last = np.array(size[::-1]) - 1.0
    inside: np.ndarray = ((centre - extent > 0.0) & (centre + extent < last)).all(axis=1)
    return inside
