"""Dots that the first look missed, looked for where their neighbours say they are."""

import numpy as np

from labcal.detect.grey import GreyPicture
from labcal.detect.lattice.lattice import Lattice, Node
from labcal.detect.lattice.numbering import AnyNumbering
from labcal.detect.lattice.prediction import Predictor
from labcal.detect.outlines.outlines import Outlines, inside_frame, mean_radius, trace_from
from labcal.targets.grid import DotGrid

_MISS = 0.12  # of a step between an outline and where it is expected
_SIZE_TOLERANCE = 0.35  # in the logarithm of the radius
_GAP = 4  # steps over hidden dots
_ROUNDS = 20  # each goes a node farther
_KEEP_MISS = 0.2  # of a step, once all neighbours are known


def with_missed(
    grey: GreyPicture, lattice: Lattice, numbering: AnyNumbering, outlines: Outlines, target: DotGrid
) -> tuple[Lattice, Outlines]:
    """Return the lattice with further dots of the declared grid, and all outlines.

    Parameters
    ----------
    grey : ndarray, shape (h, w)
    lattice : Lattice
    numbering : AnyNumbering
        Of the lattice.
    outlines : Outlines
        To which the lattice's spots refer; further ones are added at the end.
    target : DotGrid
    """
    size, first = (grey.shape[1], grey.shape[0]), len(outlines.centre)
    tried: dict[Node, int] = {}
    for _ in range(_ROUNDS):
        nodes = _beside(lattice, numbering, target)
        predictions = Predictor(lattice, outlines).predict(nodes) if nodes else {}
        expected = [
            (node, found) for node, found in predictions.items() if found.neighbours > tried.get(node, -1)
        ]
        centre = np.array([found.position for _, found in expected]).reshape(-1, 2)
        shape = np.array([found.outline for _, found in expected]).reshape(-1, 2, 2)
        inside = np.flatnonzero(inside_frame(centre, shape, size, 0.0))
        expected, centre, shape = [expected[k] for k in inside], centre[inside], shape[inside]
        tried.update((node, found.neighbours) for node, found in expected)
        if not expected:
            break
        seen, which = trace_from(grey, centre, shape, target)
        odds = np.abs(np.log(seen.radius / mean_radius(shape[which])))
        known = outlines.centre[list(lattice.spots.values())]
        spots = dict(lattice.spots)
        for number, pick in enumerate(which):
            node, found = expected[pick]
            apart = np.linalg.norm(known - seen.centre[number], axis=1).min() > seen.radius[number]
            if odds[number] < _SIZE_TOLERANCE and apart and found.miss(seen.centre[number]) < _MISS:
                spots[node] = len(outlines.centre)
                outlines = outlines.joined(seen.select(np.array([number])))
        if len(spots) == len(lattice):
            break
        lattice = Lattice(spots, lattice.flattening)
    return _consistent(lattice, outlines, first), outlines


def _consistent(lattice: Lattice, outlines: Outlines, first: int) -> Lattice:
    """Return the lattice without the added nodes that disagree with their neighbours, the worst first.

    Beyond a gap at the rim of a wide lens the step to the next dot is a guess, and may have met the one
    behind it. `first` is the number of outlines before nodes were added.
    """
    while True:
        spots = lattice.spots
        predictions = Predictor(lattice, outlines).predict([n for n, spot in spots.items() if spot >= first])
        misses = {node: found.miss(outlines.centre[spots[node]]) for node, found in predictions.items()}
        worst = max(misses, key=lambda node: misses[node], default=None)
        if worst is None or misses[worst] <= _KEEP_MISS:
            return lattice
        lattice = Lattice({node: spot for node, spot in spots.items() if node != worst}, lattice.flattening)


def _beside(lattice: Lattice, numbering: AnyNumbering, target: DotGrid) -> list[Node]:
    """Return the empty nodes of the declared grid next to the lattice's, or beyond a gap."""
    if sum(target.holds(*numbering.index(node)) for node in lattice.spots) == target.count:
        return []
    span = range(-_GAP, _GAP + 1)
    beside = {(a + i, b + j) for a, b in lattice.spots for i in span for j in span} - lattice.spots.keys()
    return [node for node in sorted(beside) if target.holds(*numbering.index(node))]
