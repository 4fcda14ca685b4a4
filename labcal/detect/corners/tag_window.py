"""Pixels of the fit of a tag's corner, and the parameters that it begins with."""

from collections.abc import Callable, Sequence
from dataclasses import dataclass

import numpy as np

from labcal.detect.corners.corner_model import CornerPixels
from labcal.detect.grey import GreyPicture

_DARK, _LIGHT = 10, 90
"""Percentiles of a window that are its black and white levels, to begin with."""


@dataclass(frozen=True)
class TagWindow:
    """The form of a window around a corner.

    Attributes
    ----------
    centre : ndarray, shape (2,)
        Rough place of the corner, px.
    edges : ndarray, shape (2, 2)
        Columns: from the corner along the tag's two edges to its next corners, px.
    reach : float
        Farthest pixel, px.
    gap : ndarray, shape (2,)
    pattern : int
        Both as of :class:`~labcal.detect.corners.corner_model.CornerPixels`.
    """

    centre: np.ndarray
    edges: np.ndarray
    reach: float
    gap: np.ndarray
    pattern: int

    def pixels(
        self, grey: GreyPicture, chosen: Callable[[np.ndarray, np.ndarray], np.ndarray]
    ) -> CornerPixels:
        """Return the pixels that are chosen by their coordinates along the edges, in lengths of these.

        Parameters
        ----------
        grey : ndarray, shape (h, w)
        chosen : callable
            Takes the smaller and the larger coordinate of all pixels, and returns a mask of them.
        """
        height, width = grey.shape
        low = np.maximum(np.ceil(self.centre - self.reach), 0).astype(int)
        high = np.minimum(np.floor(self.centre + self.reach), [width - 1, height - 1]).astype(int)
        if (high < low).any():
            empty = np.zeros((0, 0), dtype=bool)
            return CornerPixels(empty, np.zeros((2, 0)), np.zeros(0), self.gap, self.pattern)
        y, x = np.mgrid[low[1] : high[1] + 1, low[0] : high[0] + 1].astype(np.float64)
        offset = np.stack([x.ravel() - self.centre[0], y.ravel() - self.centre[1]])
        along = np.linalg.solve(self.edges, offset)
        mask = chosen(along.min(axis=0), along.max(axis=0)) & (np.hypot(*offset) < self.reach)
        value = grey[low[1] : high[1] + 1, low[0] : high[0] + 1].astype(np.float64).ravel()[mask]
        return CornerPixels(mask.reshape(x.shape), offset[:, mask], value, self.gap, self.pattern)


def normal_towards(edge: np.ndarray, side: np.ndarray) -> np.ndarray:
    """Return the normal of an edge on the side of a vector, shape (2,)."""
    normal = np.array([-edge[1], edge[0]])
    return np.asarray(normal * np.sign(normal @ side))


def first_state(window: CornerPixels, normals: Sequence[np.ndarray], blur: float) -> np.ndarray:
    """Return the first parameters of a fit.

    Parameters
    ----------
    window : CornerPixels
    normals : sequence of ndarray, shape (2,)
        Of both edges.
    blur : float
        px.
    """
    angles = [float(np.arctan2(normal[1], normal[0])) for normal in normals]
    black, white = np.percentile(window.value, [_DARK, _LIGHT])
    return np.array(
        [0.0, 0.0, *angles, blur, blur, (black + white) / 2, (white - black) / 2, 0.0, 0.0], dtype=np.float64
    )
