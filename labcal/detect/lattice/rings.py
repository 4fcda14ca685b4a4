"""Ids of a grid's nodes by the three rings."""

from dataclasses import dataclass
from functools import cached_property

import numpy as np

from labcal.detect.flags import Refusal
from labcal.detect.lattice.beside import step_lengths
from labcal.detect.lattice.lattice import Lattice, Node
from labcal.detect.medians import DEVIATIONS_A_MAD, median_of
from labcal.detect.outlines.outlines import Outlines
from labcal.detect.stage_settings.grid import GridSettings
from labcal.targets.grid import DotGrid, Rings

TURNS = tuple(
    np.array(turn) for turn in ([[1, 0], [0, 1]], [[0, -1], [1, 0]], [[-1, 0], [0, -1]], [[0, 1], [-1, 0]])
)
"""The quarter turns of a grid seen from its front."""
_MIRROR = np.array([[0, 1], [1, 0]])


@dataclass(frozen=True)
class Numbering:
    """(col, row) of a lattice node: ``turn @ node + shift``."""

    turn: np.ndarray
    shift: np.ndarray

    def index(self, node: Node) -> tuple[int, int]:
        """Return (col, row) of a node."""
        (p, q, x), (r, s, y) = self._rows
        return p * node[0] + q * node[1] + x, r * node[0] + s * node[1] + y

    def indices(self, nodes: np.ndarray) -> np.ndarray:
        """Return (col, row) of nodes, (n, 2)."""
        places: np.ndarray = nodes @ self.turn.T + self.shift
        return places

    @cached_property
    def _rows(self) -> tuple[tuple[int, int, int], tuple[int, int, int]]:
        """The turn with the shift beside it, for plain arithmetic: nodes are many."""
        (p, q), (r, s) = self.turn.tolist()
        return (p, q, int(self.shift[0])), (r, s, int(self.shift[1]))


def ring_nodes(lattice: Lattice, outlines: Outlines, settings: GridSettings) -> set[Node]:
    """Return the nodes whose dot is bright in the middle, less so in a blurred picture."""
    hole = outlines.hole[lattice.numbers]
    usual = median_of(hole)
    scatter = DEVIATIONS_A_MAD * median_of(np.abs(hole - usual))
    stands_out = usual + settings.ring_outlier_sigma * scatter
    limit = float(np.clip(stands_out, settings.faint_hole_share, settings.ring_hole_share))
    return {(a, b) for a, b in lattice.nodes[hole > limit].tolist()}


def number_by_rings(
    lattice: Lattice, outlines: Outlines, target: DotGrid, rings: Rings, settings: GridSettings
) -> Numbering | Refusal:
    """Find the one numbering that puts the target's three rings on rings of the lattice.

    Of the eight symmetries of a grid only the four quarter turns are possible, since a board is seen from its
    front. Two rings do where the third is hidden, if every other way to number the grid by them would put a
    ring where a full dot is seen.

    Returns
    -------
    Numbering or Refusal
        `NO_RINGS`, `MIRRORED` or `AMBIGUOUS_RINGS` where there is no numbering or more than one.
    """
    seen, tolerance = ring_nodes(lattice, outlines, settings), settings.pitch_ratio_log
    matches = [match for turn in TURNS for match in _matches(turn, seen, rings)]
    matches = [match for match in matches if pitches_agree(match.turn, lattice, outlines, target, tolerance)]
    if len(matches) == 1:
        return matches[0]
    if matches:
        return Refusal.AMBIGUOUS_RINGS
    if any(_matches(turn @ _MIRROR, seen, rings) for turn in TURNS):
        return Refusal.MIRRORED
    two = [match for turn in TURNS for match in _matches_of_two(turn, seen, lattice, target)]
    full = {node for node, spot in lattice.spots.items() if outlines.hole[spot] < settings.full_dot_share}
    two = [match for match in two if _is_free_of_contradiction(match, seen, full, target)]
    two = [match for match in two if pitches_agree(match.turn, lattice, outlines, target, tolerance)]
    return two[0] if len(two) == 1 else Refusal.NO_RINGS


def _matches(turn: np.ndarray, seen: set[Node], rings: Rings) -> list[Numbering]:
    """Return the numberings of one turn under which the target's rings are rings of the lattice."""
    back = turn.T  # orthogonal, so its inverse
    x_leg = back @ np.array([rings.x_steps, 0])
    y_leg = back @ np.array([0, rings.y_steps])
    return [
        Numbering(turn, np.array(rings.origin) - turn @ np.array(origin))
        for origin in sorted(seen)
        if (origin[0] + int(x_leg[0]), origin[1] + int(x_leg[1])) in seen
        and (origin[0] + int(y_leg[0]), origin[1] + int(y_leg[1])) in seen
    ]


def _matches_of_two(turn: np.ndarray, seen: set[Node], lattice: Lattice, target: DotGrid) -> list[Numbering]:
    """Return the numberings of one turn under which two of the target's rings are rings of the lattice."""
    places = [np.array(ring) for ring in target.ring_indices]
    found: dict[tuple[int, int], Numbering] = {}
    for node in sorted(seen):
        for place in places:
            numbering = Numbering(turn, place - turn @ np.array(node))
            there = sum(ring in seen for ring in _ring_places(numbering, target))
            inside = all(target.holds(*numbering.index(other)) for other in lattice.spots)
            if there == 2 and inside:  # noqa: PLR2004 - two of three
                found[(int(numbering.shift[0]), int(numbering.shift[1]))] = numbering
    return list(found.values())


def _ring_places(numbering: Numbering, target: DotGrid) -> list[Node]:
    """Return the nodes of the target's three rings."""
    back = numbering.turn.T
    nodes = [back @ (np.array(ring) - numbering.shift) for ring in target.ring_indices]
    return [(int(node[0]), int(node[1])) for node in nodes]


def _is_free_of_contradiction(
    numbering: Numbering, seen: set[Node], full: set[Node], target: DotGrid
) -> bool:
    """Tell whether no ring is seen elsewhere, and no full dot where a ring should be."""
    places = set(_ring_places(numbering, target))
    return seen <= places and not (places & full)


def pitches_agree(
    turn: np.ndarray, lattice: Lattice, outlines: Outlines, target: DotGrid, tolerance: float
) -> bool:
    """Tell whether the steps, seen in units of the dots' own ellipses, have the target's ratio.

    `tolerance` is the most that the logarithm of the ratio may be off.
    """
    lengths = [
        step_lengths(lattice.nodes, lattice.numbers, outlines.centre, outlines.shape, step)
        for step in ((1, 0), (0, 1))
    ]
    if min(len(length) for length in lengths) == 0:
        return False
    ratio = np.log(median_of(lengths[0]) / median_of(lengths[1]))
    if turn[0, 0] == 0:
        ratio = -ratio
    return bool(abs(ratio - np.log(target.pitch_x_mm / target.pitch_y_mm)) < tolerance)
