"""Dots that the first look missed, looked for where their neighbours predict them."""

import numpy as np

from labcal.detect.grey import GreyPicture
from labcal.detect.lattice.lattice import Lattice, Node
from labcal.detect.lattice.numbering import AnyNumbering
from labcal.detect.lattice.prediction import Predictor
from labcal.detect.outlines.outlines import Outlines, inside_frame, mean_radius, trace_from
from labcal.detect.settings import DetectSettings
from labcal.detect.stage_settings.grid import GridSettings
from labcal.targets.grid import DotGrid


def with_missed(
    grey: GreyPicture,
    lattice: Lattice,
    numbering: AnyNumbering,
    outlines: Outlines,
    target: DotGrid,
    settings: DetectSettings,
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
    settings : DetectSettings
    """
    limits, first = settings.grid, len(outlines.centre)
    size = (grey.shape[1], grey.shape[0])
    tried: dict[Node, int] = {}
    for _ in range(limits.missed_rounds):
        nodes = _beside(lattice, numbering, target, limits.missed_gap_nodes)
        predictions = Predictor(lattice, outlines, limits).predict(nodes) if nodes else {}
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
        seen, which = trace_from(grey, centre, shape, target, settings.segmentation)
        size_log = np.abs(np.log(seen.radius / mean_radius(shape[which])))
        known = outlines.centre[list(lattice.spots.values())]
        spots = dict(lattice.spots)
        for number, pick in enumerate(which):
            node, found = expected[pick]
            apart = np.linalg.norm(known - seen.centre[number], axis=1).min() > seen.radius[number]
            near = found.residual(seen.centre[number]) < limits.missed_residual_steps
            if size_log[number] < limits.missed_radius_log and apart and near:
                spots[node] = len(outlines.centre)
                outlines = outlines.joined(seen.select(np.array([number])))
        if len(spots) == len(lattice):
            break
        lattice = Lattice(spots, lattice.undistortion)
    return _consistent(lattice, outlines, first, limits), outlines


def _consistent(lattice: Lattice, outlines: Outlines, first: int, settings: GridSettings) -> Lattice:
    """Return the lattice without the added nodes that disagree with their neighbours, the worst first.

    Beyond a gap at the rim of a wide lens the step to the next dot is a guess, and may have met the one
    behind it. `first` is the number of outlines before nodes were added.
    """
    while True:
        spots = lattice.spots
        added = [node for node, spot in spots.items() if spot >= first]
        if not added:
            return lattice
        predictions = Predictor(lattice, outlines, settings).predict(added)
        residuals = {
            node: found.residual(outlines.centre[spots[node]]) for node, found in predictions.items()
        }
        worst = max(residuals, key=lambda node: residuals[node], default=None)
        if worst is None or residuals[worst] <= settings.missed_keep_residual_steps:
            return lattice
        lattice = Lattice({node: spot for node, spot in spots.items() if node != worst}, lattice.undistortion)


def _beside(lattice: Lattice, numbering: AnyNumbering, target: DotGrid, gap: int) -> list[Node]:
    """Return the empty nodes of the declared grid next to the lattice's, or beyond a gap."""
    if int(target.holds_each(numbering.indices(lattice.nodes)).sum()) == target.count:
        return []
    span = range(-gap, gap + 1)
    beside = {(a + i, b + j) for a, b in lattice.spots for i in span for j in span} - lattice.spots.keys()
    return [node for node in sorted(beside) if target.holds(*numbering.index(node))]
