"""Seeds of a grid: spots with neighbours one step along both axes."""

from dataclasses import dataclass

import numpy as np

from labcal.detect.outlines.outlines import Outlines, geometric_mean
from labcal.detect.stage_settings.grid import GridSettings
from labcal.geometry.two_by_two import inverses, matrix_roots
from labcal.targets.grid import DotGrid, Layout

_FLAT_ROWS = 3
"""Rows of an asymmetric grid of which a cross has corners within its own row alone."""


@dataclass(frozen=True)
class Seed:
    """A spot with those around it, by their steps along both axes, and how badly the cross fits."""

    spots: dict[tuple[int, int], int]
    misfit: float

    @property
    def middle(self) -> int:
        """The spot that the seed is about."""
        return self.spots[0, 0]


def seed_at(
    i: int, outlines: Outlines, target: DotGrid, near: np.ndarray, settings: GridSettings
) -> Seed | None:
    """Return the smallest cross around spot i whose arms are square to each other on the board.

    The dots' own ellipses show how the board is foreshortened there, so the angle and the ratio of the steps
    are known without the pose. A step is measured by the geometric mean of the ellipses at its ends, which
    is right for any perspective along the step.

    Parameters
    ----------
    i : int
    outlines : Outlines
    target : DotGrid
    near : ndarray of int
        The spots about as large as spot i, itself left out.
    settings : GridSettings
    """
    distance = np.linalg.norm(outlines.centre[near] - outlines.centre[i], axis=1)
    near = near[np.argsort(distance, kind="stable")[: settings.seed_neighbours]]
    if len(near) < settings.min_seed_neighbours:
        return None
    flatten = inverses(matrix_roots(outlines.shape[np.append(near, i)]))
    ring = outlines.hole[np.append(near, i)] > settings.ring_hole_share
    flatten[ring] *= target.ring_size
    steps = outlines.centre[near] - outlines.centre[i]
    present = np.einsum("nij,nj->ni", geometric_mean(flatten[:-1], flatten[-1]), steps)
    length = np.linalg.norm(present, axis=1)
    balanced = _nearest_distance(-present, present) < settings.seed_residual_steps * length
    arms = present[balanced]
    if len(arms) < 2:  # noqa: PLR2004 - an arm and its opposite
        return None
    expected = abs(float(np.log(target.cell_mm[0] / target.cell_mm[1])))
    corners = 2 if target.layout is Layout.ASYMMETRIC and target.rows <= _FLAT_ROWS else 3
    pair = _full_cross(arms, present, (expected, corners), settings) or _half_cross(
        arms, present, expected, settings
    )
    residual = settings.seed_residual_steps
    if pair is None or _is_coarse(pair.first, pair.second, present, residual):
        return None
    u, v = np.linalg.solve(flatten[-1], np.stack([pair.first, pair.second], axis=-1)).T
    first, second = (pair.first, pair.second) if u[0] * v[1] - u[1] * v[0] <= 0 else (pair.second, pair.first)
    # y is down in the picture and up on the board
    return Seed(_around(i, near, (first, second), present, residual), pair.misfit)


@dataclass(frozen=True)
class _Pair:
    """Two arms of a cross, and how badly it fits."""

    first: np.ndarray
    second: np.ndarray
    misfit: float


def _full_cross(
    arms: np.ndarray, present: np.ndarray, wanted: tuple[float, int], settings: GridSettings
) -> _Pair | None:
    """Return the smallest pair of arms, square to each other, with spots opposite and at the corners.

    `wanted` is the expected log ratio of the steps, and the number of corners: one of four may be missing,
    and of an asymmetric grid with three rows the two across them are.
    """
    expected, count = wanted
    opposite = _nearest_distance(-arms, present) / np.linalg.norm(arms, axis=1)
    corners = [
        _corner_residual(first * arms, second * arms, present) for first in (1, -1) for second in (1, -1)
    ]
    worst = np.sort(np.stack(corners), axis=0)[count - 1]
    misfit = np.maximum(np.maximum(opposite[:, None], opposite[None, :]), worst)
    return _smallest(arms, arms, misfit, expected, settings)


def _half_cross(
    arms: np.ndarray, present: np.ndarray, expected: float, settings: GridSettings
) -> _Pair | None:
    """Return the smallest arm with a spot opposite it, and one square to it to one side, with both corners.

    It is all there is where only two rows of dots are seen.
    """
    opposite = _nearest_distance(-arms, present) / np.linalg.norm(arms, axis=1)
    corners = np.maximum(_corner_residual(arms, present, present), _corner_residual(-arms, present, present))
    return _smallest(arms, present, np.maximum(opposite[:, None], corners), expected, settings)


def _corner_residual(first: np.ndarray, second: np.ndarray, present: np.ndarray) -> np.ndarray:
    """Return the distance of the nearest spot from the corner of each pair of arms, in steps."""
    corner = (first[:, None] + second[None, :]).reshape(-1, 2)
    shorter = np.minimum(np.linalg.norm(first, axis=1)[:, None], np.linalg.norm(second, axis=1)[None, :])
    residual: np.ndarray = _nearest_distance(corner, present).reshape(shorter.shape) / shorter
    return residual


def _smallest(
    first: np.ndarray, second: np.ndarray, misfit: np.ndarray, expected: float, settings: GridSettings
) -> _Pair | None:
    """Return the pair of the smallest cell that is square and fits; of several, the one that fits best."""
    length = np.linalg.norm(first, axis=1)[:, None], np.linalg.norm(second, axis=1)[None, :]
    cosine = np.abs(first @ second.T) / (length[0] * length[1])
    ratio = np.abs(np.log(length[0] / length[1]))
    skew = np.maximum(cosine, np.abs(ratio - expected))
    fits = (skew < settings.seed_shape_log) & (misfit < settings.seed_residual_steps)
    if not fits.any():
        return None
    area = np.where(fits, length[0] * length[1], np.inf)
    smallest = np.where(area < settings.seed_cell_factor * area.min(), misfit, np.inf)
    i, j = np.unravel_index(int(smallest.argmin()), smallest.shape)
    return _Pair(first[i], second[j], float(smallest.min()))


def _around(
    i: int, near: np.ndarray, arms: tuple[np.ndarray, np.ndarray], present: np.ndarray, most: float
) -> dict[tuple[int, int], int]:
    """Return the spots of a cross and its corners, by their steps."""
    spots = {(0, 0): i}
    limit = most * min(float(np.linalg.norm(arm)) for arm in arms)
    for a, b in ((1, 0), (0, 1), (-1, 0), (0, -1), (1, 1), (1, -1), (-1, 1), (-1, -1)):
        residual = np.linalg.norm(present - (a * arms[0] + b * arms[1]), axis=1)
        nearest = int(residual.argmin())
        if residual[nearest] < limit and int(near[nearest]) not in spots.values():
            spots[a, b] = int(near[nearest])
    return spots


def _is_coarse(u: np.ndarray, v: np.ndarray, present: np.ndarray, most: float) -> bool:
    """Tell whether spots lie half-way in the cells: for want of a neighbour the seed skips every other."""
    limit = most * min(float(np.linalg.norm(u)), float(np.linalg.norm(v)))
    corners = np.array([u + v, u - v, -u + v, -u - v]) / 2
    across = np.array([a / 2 + k * v for a in (u, -u) for k in (-1, 0, 1)])
    along = np.array([b / 2 + k * u for b in (v, -v) for k in (-1, 0, 1)])
    return any(
        int((_nearest_distance(halves, present) < limit).sum()) > 1 for halves in (corners, across, along)
    )


def _nearest_distance(wanted: np.ndarray, present: np.ndarray) -> np.ndarray:
    """Return the distance of each wanted place to the nearest present spot."""
    squares = (wanted**2).sum(1)[:, None] + (present**2).sum(1)[None, :] - 2 * wanted @ present.T
    nearest: np.ndarray = np.sqrt(np.maximum(squares.min(axis=1), 0))
    return nearest
