"""Spots that form a grid: small crosses as seeds, grown node by node and checked against their neighbours."""

from dataclasses import dataclass
from functools import cached_property

import numpy as np

from labcal.arrays import PixelCovariances, Pixels
from labcal.detect.grid_kernel import PREDICTION, drop_inconsistent, grow, miss, predict
from labcal.detect.outlines import Outlines
from labcal.detect.seeds import SEED_MISS, Seed, seed_at
from labcal.targets.grid import DotGrid

Node = tuple[int, int]

_SIZE_TOLERANCE = 0.35  # in the logarithm of the radius, between neighbours
_GOOD_SEED = 0.06  # of a step: a seed that fits so well is grown at once
_MOST_SPOTS = 4000  # beyond this the smallest are left out
_MOST_SEEDS = 600  # looked for, in a picture full of what is no grid
_MOST_COMPONENTS = 12
_FARTHEST = 250  # nodes from a seed
_AROUND = 4  # empty nodes kept around a lattice
_LINKS = (
    (1, 0),
    (-1, 0),
    (0, 1),
    (0, -1),
    (1, 1),
    (1, -1),
    (-1, 1),
    (-1, -1),
    (2, 0),
    (-2, 0),
    (0, 2),
    (0, -2),
)


@dataclass(frozen=True)
class Prediction:
    """A node's predicted position (px) and the local steps along both axes (columns of `steps`, px)."""

    position: np.ndarray
    steps: np.ndarray

    def miss(self, position: np.ndarray) -> float:
        """Return how many steps `position` is from the prediction; infinite on a degenerate grid."""
        numbers = np.concatenate([self.position, self.steps.T.ravel()])
        return float(miss(numbers, float(position[0]), float(position[1])))


@dataclass(frozen=True)
class Lattice:
    """Spots on grid nodes; the numbering is right up to a shift and a quarter turn, and never mirrored."""

    spots: dict[Node, int]

    def __len__(self) -> int:
        """Return the number of nodes that hold a spot."""
        return len(self.spots)

    @cached_property
    def _grid(self) -> tuple[np.ndarray, np.ndarray]:
        """The spots as an array, -1 where there is none, and the node of its first entry."""
        nodes = np.array(list(self.spots))
        corner = nodes.min(axis=0) - _AROUND
        grid = np.full(nodes.max(axis=0) + 1 + _AROUND - corner, -1)
        grid[tuple((nodes - corner).T)] = list(self.spots.values())
        return grid, corner

    def around(self, node: Node) -> np.ndarray:
        """Return the spots on the nodes within two steps of one, itself left out."""
        grid, corner = self._grid
        a, b = np.array(node) - corner
        window: np.ndarray = grid[max(a - 2, 0) : a + 3, max(b - 2, 0) : b + 3].ravel()
        near: np.ndarray = window[(window >= 0) & (window != self.spots.get(node, -1))]
        return near

    def predict(self, node: Node, positions: Pixels) -> Prediction | None:
        """Predict a node from its neighbours; None where these are too few or lie on one line."""
        grid, corner = self._grid
        numbers = np.empty(PREDICTION)
        a, b = np.array(node) - corner
        if not predict(grid, positions, int(a), int(b), numbers):
            return None
        return Prediction(numbers[:2], numbers[2:].reshape(2, 2).T)


def size_tolerance(target: DotGrid) -> float:
    """Return by how much the logarithms of the radii of two neighbours may differ."""
    return _SIZE_TOLERANCE + abs(float(np.log(target.ring_outer_diameter_mm / target.dot_diameter_mm)))


def find_lattices(outlines: Outlines, target: DotGrid) -> list[Lattice]:
    """Return the grids that the spots form, largest first.

    Nodes are numbered from a seed's middle so that the first axis turned by 90 degrees anticlockwise in the
    picture gives the second, as the columns and rows of a board seen from its front.
    """
    radius = outlines.radius
    order = np.argsort(-radius, kind="stable")[:_MOST_SPOTS]
    tolerance = size_tolerance(target)
    free = np.zeros(len(radius), dtype=bool)
    free[order] = True
    lattices: list[Lattice] = []
    doubtful: list[Seed] = []
    for i in order[:: max(1, len(order) // _MOST_SEEDS)]:
        if not free[i] or len(lattices) == _MOST_COMPONENTS:
            continue
        near = np.flatnonzero(np.abs(np.log(radius / radius[i])) < tolerance)
        seed = seed_at(int(i), outlines, target, near[near != i])
        if seed is not None and seed.misfit < _GOOD_SEED:
            lattices += _grown(seed, outlines, free, tolerance)
        elif seed is not None:
            doubtful.append(seed)
    for seed in sorted(doubtful, key=lambda seed: seed.misfit):
        if free[seed.middle] and len(lattices) < _MOST_COMPONENTS:
            lattices += _grown(seed, outlines, free, tolerance)
    return sorted(lattices, key=len, reverse=True)


def _grown(seed: Seed, outlines: Outlines, free: np.ndarray, tolerance: float) -> list[Lattice]:
    """Return the lattice that grows from a seed, or none, and take its spots."""
    centre, radius = outlines.centre, outlines.radius
    similar = np.abs(np.log(radius / radius[seed.middle])) < 3 * tolerance
    far = min(len(radius), _FARTHEST)
    grid = np.full((2 * far + 1, 2 * far + 1), -1)
    grid[far, far] = seed.middle
    u, v = (centre[k] - centre[seed.middle] for k in seed.along)
    step = min(float(np.linalg.norm(u)), float(np.linalg.norm(v)))
    usable = free & similar
    usable[seed.middle] = False
    for a, b in ((1, 0), (0, 1), (-1, 0), (0, -1), (1, 1), (1, -1), (-1, 1), (-1, -1)):
        distance = np.linalg.norm(centre - (centre[seed.middle] + a * u + b * v), axis=1)
        distance[~usable] = np.inf
        nearest = int(distance.argmin())
        if distance[nearest] < SEED_MISS * step:
            grid[far + a, far + b] = nearest
            usable[nearest] = False
    grow(grid, centre, radius, usable, _SIZE_TOLERANCE + 0.2)
    nodes = np.argwhere(grid >= 0)
    low, high = nodes.min(axis=0), nodes.max(axis=0)
    grid = np.pad(grid[low[0] : high[0] + 1, low[1] : high[1] + 1], _AROUND, constant_values=-1)
    drop_inconsistent(grid, centre)
    spots = {(int(a), int(b)): int(grid[a, b]) for a, b in np.argwhere(grid >= 0)}
    spots = _largest_part(spots)
    free[seed.middle] = False
    free[list(spots.values())] = False
    return [Lattice(spots)] if spots else []


def _largest_part(known: dict[Node, int]) -> dict[Node, int]:
    """Return the largest set of nodes that hang together, gaps of one node bridged."""
    left = set(known)
    best: set[Node] = set()
    while left:
        part, edge = set(), {min(left)}
        while edge:
            part |= edge
            edge = {(a + i, b + j) for a, b in edge for i, j in _LINKS if (a + i, b + j) in left} - part
        left -= part
        if len(part) > len(best):
            best = part
    return {node: known[node] for node in sorted(best)}


def typical_outline(lattice: Lattice, node: Node, outlines: Outlines) -> PixelCovariances:
    """Return the median outline matrix of the dots around a node, shape (2, 2)."""
    shape: np.ndarray = np.median(outlines.shape[lattice.around(node)], axis=0)
    return shape
