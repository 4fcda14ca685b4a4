"""Spots that form a grid: small crosses as seeds, grown node by node and checked against their neighbours."""

from dataclasses import dataclass

import numpy as np

from labcal.detect.neighbours import Node, around, predict
from labcal.detect.outlines import Outlines, matrix_root
from labcal.targets.grid import DotGrid

_NEAREST = 24  # spots looked at around a seed: two rings of neighbours
_SIZE_TOLERANCE = 0.35  # in the logarithm of the radius, between neighbours
_SHAPE_TOLERANCE = 0.35  # cosine of the angle, and logarithm of the ratio of the steps, in a seed
_SEED_MISS = 0.15  # of a step, in a seed
_GROW_MISS = 0.25  # of a step, where a node is added
_KEEP_MISS = 0.12  # of a step, once all neighbours are known
_MOST_SPOTS = 4000  # beyond this the smallest are left out
_MOST_COMPONENTS = 12
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
class Lattice:
    """Spots on grid nodes; the numbering is right up to a shift and a quarter turn, and never mirrored."""

    spots: dict[Node, int]

    def __len__(self) -> int:
        """Return the number of nodes that hold a spot."""
        return len(self.spots)


@dataclass(frozen=True)
class _Seed:
    """A spot with the neighbours one step along both axes, and how badly the cross fits."""

    middle: int
    along: tuple[int, int]
    misfit: float


def find_lattices(outlines: Outlines, target: DotGrid) -> list[Lattice]:
    """Return the grids that the spots form, largest first.

    Nodes are numbered from a seed's middle so that the first axis turned by 90 degrees anticlockwise in the
    picture gives the second, as the columns and rows of a board seen from its front.
    """
    order = np.argsort(-outlines.radius, kind="stable")[:_MOST_SPOTS]
    tolerance = _SIZE_TOLERANCE + abs(np.log(target.ring_size))
    seeds = [seed for i in order if (seed := _seed(int(i), outlines, target, tolerance)) is not None]
    seeds.sort(key=lambda seed: seed.misfit)
    taken: set[int] = set()
    lattices: list[Lattice] = []
    for seed in seeds:
        if seed.middle in taken or len(lattices) == _MOST_COMPONENTS:
            continue
        grown = _largest_part(_consistent(_grow(seed, outlines, tolerance), outlines))
        taken.update(grown.values())
        taken.add(seed.middle)
        if grown:
            lattices.append(Lattice(grown))
    return sorted(lattices, key=len, reverse=True)


def _similar(outlines: Outlines, i: int, tolerance: float) -> np.ndarray:
    """Return the spots about as large as spot i, itself left out."""
    radius = outlines.radius
    similar = np.abs(np.log(radius / radius[i])) < tolerance
    similar[i] = False
    return np.flatnonzero(similar)


def _seed(i: int, outlines: Outlines, target: DotGrid, tolerance: float) -> _Seed | None:
    """Return the smallest cross around spot i whose arms are square to each other on the board.

    The dot's own ellipse says how the board is foreshortened there, so the angle and the ratio of the steps
    are known without the pose.
    """
    near = _similar(outlines, i, tolerance)
    distance = np.linalg.norm(outlines.centre[near] - outlines.centre[i], axis=1)
    near = near[np.argsort(distance, kind="stable")[:_NEAREST]]
    if len(near) < 7:  # noqa: PLR2004 - a cross and three of its corners
        return None
    flatten = np.linalg.inv(matrix_root(outlines.shape[i]))
    arms = (outlines.centre[near] - outlines.centre[i]) @ flatten.T
    length = np.linalg.norm(arms, axis=1)
    balanced = _nearest_miss(-arms, arms) < _SEED_MISS * length
    present, near, arms, length = arms, near[balanced], arms[balanced], length[balanced]
    if len(arms) < 4:  # noqa: PLR2004 - the arms of a cross
        return None
    cosine = np.abs(arms @ arms.T) / np.outer(length, length)
    ratio = np.log(length[:, None] / length[None, :])
    expected = np.log(target.cell_mm[0] / target.cell_mm[1])
    square = (cosine < _SHAPE_TOLERANCE) & (np.abs(np.abs(ratio) - abs(expected)) < _SHAPE_TOLERANCE)
    opposite = _nearest_miss(-arms, present) / length
    corners = [
        _nearest_miss((first * arms[:, None] + second * arms[None, :]).reshape(-1, 2), present).reshape(
            square.shape
        )
        / np.minimum(length[:, None], length[None, :])
        for first in (1, -1)
        for second in (1, -1)
    ]
    third_best = np.sort(np.stack(corners), axis=0)[2]  # one corner may be missing
    misfit = np.maximum(np.maximum(opposite[:, None], opposite[None, :]), third_best)
    fits = square & (misfit < _SEED_MISS)
    if not fits.any():
        return None
    area = np.where(fits, np.outer(length, length), np.inf)
    # Several pairs span the same smallest cell; the one that fits best is taken.
    smallest = np.where(area < 1.3 * area.min(), misfit, np.inf)
    first, second = np.unravel_index(int(smallest.argmin()), smallest.shape)
    if _is_coarse(arms[first], arms[second], present):
        return None
    u, v = (outlines.centre[near[k]] - outlines.centre[i] for k in (first, second))
    if u[0] * v[1] - u[1] * v[0] > 0:  # y is down in the picture and up on the board
        first, second = second, first
    return _Seed(i, (int(near[first]), int(near[second])), float(smallest.min()))


def _is_coarse(u: np.ndarray, v: np.ndarray, present: np.ndarray) -> bool:
    """Tell whether spots lie half-way in the cells: for want of a neighbour the seed skips every other."""
    limit = _SEED_MISS * min(float(np.linalg.norm(u)), float(np.linalg.norm(v)))
    corners = np.array([u + v, u - v, -u + v, -u - v]) / 2
    across = np.array([a / 2 + k * v for a in (u, -u) for k in (-1, 0, 1)])
    along = np.array([b / 2 + k * u for b in (v, -v) for k in (-1, 0, 1)])
    return any(int((_nearest_miss(halves, present) < limit).sum()) > 1 for halves in (corners, across, along))


def _nearest_miss(wanted: np.ndarray, present: np.ndarray) -> np.ndarray:
    """Return the distance of each wanted place to the nearest present spot."""
    squares = (wanted**2).sum(1)[:, None] + (present**2).sum(1)[None, :] - 2 * wanted @ present.T
    nearest: np.ndarray = np.sqrt(np.maximum(squares.min(axis=1), 0))
    return nearest


def _grow(seed: _Seed, outlines: Outlines, tolerance: float) -> dict[Node, int]:
    """Return the nodes reached from a seed, from its cross outward, each by its neighbours' prediction."""
    centre = outlines.centre
    similar = _similar(outlines, seed.middle, 3 * tolerance)
    known: dict[Node, int] = {(0, 0): seed.middle}
    u, v = (centre[k] - centre[seed.middle] for k in seed.along)
    for node in ((1, 0), (0, 1), (-1, 0), (0, -1), (1, 1), (1, -1), (-1, 1), (-1, -1)):
        place = centre[seed.middle] + node[0] * u + node[1] * v
        nearest = int(similar[np.linalg.norm(centre[similar] - place, axis=1).argmin()])
        near = np.linalg.norm(centre[nearest] - place) < _SEED_MISS * min(
            np.linalg.norm(u), np.linalg.norm(v)
        )
        if near and nearest not in known.values():
            known[node] = nearest
    tried: dict[Node, int] = {}
    reach = 1
    while True:
        found = _next_ring(known, similar, outlines, tried, reach) if known else []
        added = False
        for _, node, spot in sorted(found):
            if node not in known and spot not in known.values():
                known[node] = spot
                added = True
        if not added:
            if reach == 2:  # noqa: PLR2004 - a gap of one node is bridged, no wider one
                return known
            reach = 2
            tried = {}
        else:
            reach = 1


def _next_ring(
    known: dict[Node, int], similar: np.ndarray, outlines: Outlines, tried: dict[Node, int], reach: int
) -> list[tuple[float, Node, int]]:
    """Return the empty nodes near the known ones that a spot agrees with: (miss, node, spot)."""
    span = range(-reach, reach + 1)
    empty = {(a + i, b + j) for a, b in known for i in span for j in span} - known.keys()
    used = set(known.values())
    free = np.array([k for k in similar if k not in used], dtype=int)
    radius = outlines.radius
    found: list[tuple[float, Node, int]] = []
    if len(free) == 0:
        return found
    for node in sorted(empty):
        neighbours = around(node, known)
        if tried.get(node) == len(neighbours):
            continue
        tried[node] = len(neighbours)
        prediction = predict(node, known, outlines.centre)
        if prediction is None:
            continue
        spot = int(free[((outlines.centre[free] - prediction.position) ** 2).sum(axis=1).argmin()])
        expected = float(np.median(radius[[known[n] for n in neighbours]]))
        miss = prediction.miss(outlines.centre[spot])
        if miss < _GROW_MISS and abs(np.log(radius[spot] / expected)) < _SIZE_TOLERANCE + 0.2:
            found.append((miss, node, spot))
    return found


def _consistent(known: dict[Node, int], outlines: Outlines) -> dict[Node, int]:
    """Return the nodes that agree with their neighbours; the worst is dropped until all do.

    A row linked one step off disagrees along its seam; dropping the seam cuts the grid in parts.
    """
    kept = dict(known)
    misses = {node: _miss(node, kept, outlines) for node in kept}
    while misses:
        worst = max(misses, key=lambda node: (misses[node], node))
        if misses[worst] <= _KEEP_MISS:
            break
        del kept[worst], misses[worst]
        for node in around(worst, kept):
            misses[node] = _miss(node, kept, outlines)
    return kept


def _miss(node: Node, known: dict[Node, int], outlines: Outlines) -> float:
    """Return how far a spot is from what its neighbours say, in steps; infinite where they say nothing."""
    prediction = predict(node, known, outlines.centre)
    return np.inf if prediction is None else prediction.miss(outlines.centre[known[node]])


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
