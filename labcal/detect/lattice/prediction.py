"""Predicted places of the nodes of a lattice, and predicted outlines of their dots."""

from dataclasses import dataclass
from functools import cached_property

import numpy as np

from labcal.arrays import PixelCovariances
from labcal.detect.lattice.beside import neighbour_counts, shapes_by_steps
from labcal.detect.lattice.lattice import Lattice, Node
from labcal.detect.lattice.neighbourhood import PredictionLimits, predict_all, residual_in_steps
from labcal.detect.lattice.rough_undistortion import RoughUndistortion
from labcal.detect.matrices import inverses, mapped
from labcal.detect.medians import medians_along
from labcal.detect.outlines.outlines import Outlines
from labcal.detect.stage_settings.grid import GridSettings


@dataclass(frozen=True)
class Prediction:
    """Predicted place of a node in the picture; its place and steps in the undistorted picture, px."""

    position: np.ndarray
    steps: np.ndarray
    """Of the picture's grid along both axes there, in columns, shape (2, 2), px."""
    outline: np.ndarray
    """Matrix of the outline that a dot should have there, shape (2, 2), px squared."""
    neighbours: int
    undistortion: RoughUndistortion
    values: np.ndarray

    def residual(self, position: np.ndarray) -> float:
        """Return how many steps a pixel is from the prediction; infinite on a degenerate grid."""
        x, y = self.undistortion.undistort(position)
        return float(residual_in_steps(self.values, float(x), float(y)))


class Predictor:
    """A lattice, its spots in the undistorted picture, and the shape of its dots.

    Parameters
    ----------
    lattice : Lattice
    outlines : Outlines
        To which the lattice's spots refer.
    settings : GridSettings
    """

    def __init__(self, lattice: Lattice, outlines: Outlines, settings: GridSettings) -> None:
        around = settings.missed_gap_nodes  # empty nodes that may be predicted
        self._limits = settings.limits(PredictionLimits)
        nodes = lattice.nodes
        self._corner = nodes.min(axis=0) - around
        self._nodes, self._spots = nodes - self._corner, lattice.numbers
        self._grid = np.full(self._nodes.max(axis=0) + 1 + around, -1)
        self._grid[tuple(self._nodes.T)] = self._spots
        self.lattice, self.outlines = lattice, outlines
        self._flat = lattice.undistortion.outlines(outlines)

    @cached_property
    def _predictions(self) -> np.ndarray:
        """The predictions of the lattice's own nodes."""
        return predict_all(self._grid, self._flat.centre, self._nodes, self._limits)

    @cached_property
    def _shape(self) -> np.ndarray:
        """The usual shape of a dot in units of the grid's steps."""
        shapes = self.shapes_in_steps(self.outlines)
        known = np.isfinite(shapes[:, 0, 0])
        usual: np.ndarray = medians_along(shapes[known]) if known.any() else np.zeros((2, 2))
        return usual

    def shapes_in_steps(self, outlines: Outlines) -> PixelCovariances:
        """Return shapes of the lattice's spots in units of the grid's steps, in their order, by `outlines`.

        Wherever a board is seen from, all its dots have one shape there. NaN where a node has no prediction.
        """
        values, flat = self._predictions, self.lattice.undistortion.outlines(outlines)
        return shapes_by_steps(values, flat.shape, self._spots)

    def predict(self, nodes: list[Node]) -> dict[Node, Prediction]:
        """Return predictions of nodes; those are left out whose neighbours are too few or on one line."""
        if not nodes:
            return {}
        known, values, positions, steps, outlines, near = self.predicted(np.array(nodes))
        undistortion = self.lattice.undistortion
        return {
            nodes[k]: Prediction(position, step, outline, int(count), undistortion, value)
            for k, value, position, step, outline, count in zip(
                known, values, positions, steps, outlines, near, strict=True
            )
        }

    def predicted(self, nodes: np.ndarray) -> tuple[np.ndarray, ...]:
        """Return the numbers of nodes, shape (n, 2), that have predictions, and what `Prediction` holds.

        In this order: numbers, values, positions, steps, outlines, neighbours.
        """
        places = nodes - self._corner
        values = predict_all(self._grid, self._flat.centre, places, self._limits)
        known = np.flatnonzero(np.isfinite(values[:, 0]))
        undistortion, values = self.lattice.undistortion, values[known]
        positions = undistortion.distort(values[:, :2])
        steps = np.swapaxes(values[:, 2:].reshape(-1, 2, 2), 1, 2)
        if not undistortion.is_none:
            steps = inverses(undistortion.slopes(positions)) @ steps
        outlines = mapped(np.ascontiguousarray(steps), self._shape[None])
        return known, values, positions, steps, outlines, neighbour_counts(self._grid, places[known])

    def neighbours(self) -> np.ndarray:
        """Return how many neighbours each of the lattice's nodes has, in their order."""
        return neighbour_counts(self._grid, self._nodes)
