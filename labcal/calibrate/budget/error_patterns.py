"""Patterns of errors that dots of a view share, and their products with the derivatives of an adjustment."""

from collections.abc import Iterator
from dataclasses import dataclass

import numpy as np
from jaxtyping import Float64, Int64

from labcal.calibrate.adjustment.blocks import picture_moves
from labcal.calibrate.adjustment.observations import Observations, Picture
from labcal.calibrate.adjustment.problem import ViewsEliminated
from labcal.calibrate.adjustment.rows import SHIFT, linearised_rows
from labcal.calibrate.adjustment.state import POSE
from labcal.optim.robust import SQUARES

SMOOTH, BOARD, WHOLE = 0, 1, 2
"""Kinds of patterns: smooth over a picture; smooth over the board, where all cameras see the same; and a
shift of a whole picture with a change of its scale and shear."""
REACH = 1.0 / 6.0
"""Standard deviation of the Gaussian correlation of smooth errors, in sides of the target."""
_PATTERNS = 20
"""Of smooth errors along an axis, the largest; they hold nine tenths of the variance, and stand for all."""
_ANCHORS = 200
"""Dots between which correlations are computed; patterns at others follow."""
_PLANE = 2
_AFFINE = 3
"""Along each axis: a shift, and two slopes that reach 1 at half a side of the target."""


@dataclass(frozen=True)
class ViewSums:
    """Products of the patterns of one view with derivatives and residuals, its pose eliminated; whitened.

    Attributes
    ----------
    square : float64 array, (patterns, patterns)
        Products of the patterns.
    shared : float64 array, (shared, patterns)
        Products of the derivatives by all that views share and of the patterns.
    found : float64 array, (patterns,)
        Products of the patterns and the residuals.
    """

    square: Float64[np.ndarray, "patterns patterns"]
    shared: Float64[np.ndarray, "shared patterns"]
    found: Float64[np.ndarray, " patterns"]


@dataclass(frozen=True)
class ErrorPatterns:
    """Patterns by dot, of one unit of variance.

    Attributes
    ----------
    smooth, affine : float64 array, (dots, patterns)
        Factors of the covariance of smooth errors (the product with its transpose), and shift and slopes.
    cameras : int
    """

    smooth: Float64[np.ndarray, "dots smooth"]
    affine: Float64[np.ndarray, "dots affine"]
    cameras: int

    @classmethod
    def of(
        cls, dots: Float64[np.ndarray, "dots 3"], measured: Int64[np.ndarray, " measured"], cameras: int
    ) -> "ErrorPatterns":
        """Return the patterns of a target.

        Parameters
        ----------
        dots : ndarray, shape (dots, 3)
            Places in the target's frame, mm.
        measured : ndarray, shape (measured,)
            Numbers of the dots that were.
        cameras : int

        Notes
        -----
        The covariance between some of the dots gives eigenvectors, and these the patterns at all dots
        (Nystroem's approximation, exact where there are few dots).
        """
        place = dots[:, :_PLANE]
        spread = np.ptp(place[measured], axis=0)
        side = float(np.sqrt(spread.prod())) or float(spread.max()) or 1.0
        anchors = place[measured[:: -(-len(measured) // _ANCHORS)]]
        size, axes = np.linalg.eigh(_correlation(anchors, anchors, REACH * side))
        size, axes = size[::-1][:_PATTERNS], axes[:, ::-1][:, :_PATTERNS]
        known = size > 1e-9 * size[0]
        smooth = _correlation(place, anchors, REACH * side) @ (axes[:, known] / np.sqrt(size[known]))
        smooth /= np.sqrt((smooth[measured] ** 2).sum(axis=1).mean())
        slopes = (place - place[measured].mean(axis=0)) / (0.5 * side)
        return cls(smooth, np.concatenate([np.ones((len(dots), 1)), slopes], axis=1), cameras)

    @property
    def kinds(self) -> Int64[np.ndarray, " patterns"]:
        """The kind of each pattern of a view."""
        own = [SMOOTH] * (2 * self.smooth.shape[1]) + [WHOLE] * (2 * _AFFINE)
        return np.array(own * self.cameras + [BOARD] * (2 * self.smooth.shape[1]), dtype=np.int64)

    def sums(self, end: ViewsEliminated, observations: Observations) -> Iterator[ViewSums]:
        """Return the sums of every view with observations."""
        patterns, shared = len(self.kinds), end.layout.count
        views = len(end.layout.state.T_world_target)
        square, found = np.zeros((views, patterns, patterns)), np.zeros((views, patterns))
        across, by_pose = np.zeros((views, shared, patterns)), np.zeros((views, POSE, patterns))
        for run in observations.runs:
            rows = linearised_rows(end.layout, observations, run, SQUARES)
            moves = picture_moves(end.layout, run.camera, end.layout.state.T_world_target[run.views])
            for (picture, at), move in zip(run.within(), moves, strict=True):
                here = rows[:, :, at]
                by_dot = _by_dot(end, picture, here)
                P = self._of_picture(observations, picture, by_dot).reshape(patterns, -1)
                along = (move.T @ here.reshape(len(here), -1)) @ P.T
                own, view = end.layout.own(picture.camera), picture.view
                width = own.stop - own.start
                across[view, own] += along[:width]
                by_pose[view] += along[width:-1]
                found[view] += along[-1]
                square[view] += P @ P.T
                free = end.layout.freedom.dots
                if free.shape[1]:
                    moved = by_dot.transpose(2, 0, 1) @ P.reshape(patterns, 2, -1).transpose(2, 1, 0)
                    basis = free.reshape(-1, 3, free.shape[1])[observations.dot[picture.rows]]
                    across[view, end.layout.dots] += np.tensordot(basis, moved, axes=((0, 1), (0, 1)))
        for view in np.unique(observations.view).tolist():
            step = np.linalg.solve(end.blocks.view[view], by_pose[view])
            yield ViewSums(
                square[view] - by_pose[view].T @ step,
                across[view] - end.blocks.cross[view] @ step,
                found[view] - step.T @ end.blocks.gradient.view[view],
            )

    def _of_picture(
        self, observations: Observations, picture: Picture, by_dot: Float64[np.ndarray, "3 2 n"]
    ) -> Float64[np.ndarray, "patterns 2 n"]:
        """Return all patterns in one picture; 0 for those of other cameras."""
        dot = observations.dot[picture.rows]
        smooth, affine = self.smooth[dot].T, self.affine[dot].T
        own = np.concatenate([_along_axes(smooth), _along_axes(affine)])
        found = np.zeros((len(self.kinds), 2, len(dot)))
        first = picture.camera * len(own)
        found[first : first + len(own)] = observations.whitener.rows(picture.rows).whiten(own)
        found[-2 * len(smooth) :] = np.concatenate([by_dot[axis] * smooth[:, None] for axis in range(_PLANE)])
        return found


def _by_dot(
    end: ViewsEliminated, picture: Picture, rows: Float64[np.ndarray, "width 2 n"]
) -> Float64[np.ndarray, "3 2 n"]:
    """Return the derivatives by each dot's place in the target's frame, whitened."""
    state = end.layout.state
    R = state.cameras[picture.camera].T_cam_world[:3, :3] @ state.T_world_target[picture.view, :3, :3]
    return np.tensordot(R, rows[SHIFT], axes=(0, 0))


def _along_axes(values: Float64[np.ndarray, "k n"]) -> Float64[np.ndarray, "twice 2 n"]:
    """Return patterns along u, then along v."""
    both = np.zeros((2, len(values), 2, values.shape[1]))
    both[0, :, 0] = both[1, :, 1] = values
    return both.reshape(2 * len(values), 2, -1)


def _correlation(
    one: Float64[np.ndarray, "m 2"], other: Float64[np.ndarray, "n 2"], reach: float
) -> Float64[np.ndarray, "m n"]:
    """Return the Gaussian correlation of places."""
    square = ((one[:, None] - other[None]) ** 2).sum(axis=-1)
    return np.asarray(np.exp(-0.5 * square / reach**2))
