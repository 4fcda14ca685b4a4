"""From a grid without a name to ids: the three rings say which node is which."""

from dataclasses import dataclass

import numpy as np

from labcal.detect.flags import Refusal
from labcal.detect.lattice import Lattice, Node
from labcal.detect.outlines import Outlines, matrix_root
from labcal.targets.grid import DotGrid

_HOLE = 0.3  # of the step from dot to board: the middle of a ring is at least so bright
_PITCH_TOLERANCE = 0.3  # in the logarithm of pitch_x over pitch_y

_TURNS = tuple(
    np.array(turn) for turn in ([[1, 0], [0, 1]], [[0, -1], [1, 0]], [[-1, 0], [0, -1]], [[0, 1], [-1, 0]])
)
_MIRROR = np.array([[0, 1], [1, 0]])


@dataclass(frozen=True)
class Numbering:
    """(col, row) of a lattice node: ``turn @ node + shift``."""

    turn: np.ndarray
    shift: np.ndarray

    def index(self, node: Node) -> tuple[int, int]:
        """Return (col, row) of a node."""
        (p, q), (r, s) = self.turn.tolist()
        return p * node[0] + q * node[1] + int(self.shift[0]), r * node[0] + s * node[1] + int(self.shift[1])


def ring_nodes(lattice: Lattice, outlines: Outlines) -> set[Node]:
    """Return the nodes whose dot is bright in the middle."""
    return {node for node, spot in lattice.spots.items() if outlines.hole[spot] > _HOLE}


def number_lattice(lattice: Lattice, outlines: Outlines, target: DotGrid) -> Numbering | Refusal:
    """Find the one numbering that puts the target's three rings on rings of the lattice.

    Of the eight symmetries of a grid only the four quarter turns are possible, since a board is seen from its
    front. All three rings must be seen.

    Returns
    -------
    Numbering or Refusal
        `NO_RINGS`, `MIRRORED` or `AMBIGUOUS_RINGS` where there is no numbering or more than one.
    """
    rings = ring_nodes(lattice, outlines)
    matches = [match for turn in _TURNS for match in _matches(turn, rings, target)]
    matches = [match for match in matches if _pitches_agree(match.turn, lattice, outlines, target)]
    if len(matches) == 1:
        return matches[0]
    if matches:
        return Refusal.AMBIGUOUS_RINGS
    if any(_matches(turn @ _MIRROR, rings, target) for turn in _TURNS):
        return Refusal.MIRRORED
    return Refusal.NO_RINGS


def _matches(turn: np.ndarray, rings: set[Node], target: DotGrid) -> list[Numbering]:
    """Return the numberings of one turn under which the target's rings are rings of the lattice."""
    back = turn.T  # orthogonal, so its inverse
    x_leg = back @ np.array([target.rings.x_steps, 0])
    y_leg = back @ np.array([0, target.rings.y_steps])
    return [
        Numbering(turn, np.array(target.rings.origin) - turn @ np.array(origin))
        for origin in sorted(rings)
        if (origin[0] + int(x_leg[0]), origin[1] + int(x_leg[1])) in rings
        and (origin[0] + int(y_leg[0]), origin[1] + int(y_leg[1])) in rings
    ]


def _pitches_agree(turn: np.ndarray, lattice: Lattice, outlines: Outlines, target: DotGrid) -> bool:
    """Tell whether the steps, seen in units of the dots' own ellipses, have the target's ratio."""
    flatten = np.linalg.inv(matrix_root(outlines.shape))
    lengths: list[np.ndarray] = []
    for step in ((1, 0), (0, 1)):
        pairs = [
            (spot, lattice.spots[neighbour])
            for (a, b), spot in lattice.spots.items()
            if (neighbour := (a + step[0], b + step[1])) in lattice.spots
        ]
        if not pairs:
            return False
        here, there = np.array(pairs).T
        flat = np.einsum("nij,nj->ni", flatten[here], outlines.centre[there] - outlines.centre[here])
        lengths.append(np.linalg.norm(flat, axis=1))
    ratio = np.log(np.median(lengths[0]) / np.median(lengths[1]))
    if turn[0, 0] == 0:
        ratio = -ratio
    return bool(abs(ratio - np.log(target.pitch_x_mm / target.pitch_y_mm)) < _PITCH_TOLERANCE)
