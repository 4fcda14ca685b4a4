"""Dots that are in the picture, and whose place in the grid is known, but that cannot be measured."""

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np

from labcal.detect.blobs import Blobs
from labcal.detect.flags import DotFlag
from labcal.detect.lattice import Lattice, Node
from labcal.detect.outlines import Outlines, inside_frame, mean_radius
from labcal.detect.prediction import Prediction, Predictor

_MARGIN = 1.0  # px: an outline predicted so near to the frame may be cut
_NEAR_MISS = 0.5  # radii between a spot and where its node is expected
_CUT_MISS = 0.35  # radii between a cut spot's box and the part of the predicted outline that is in the frame
_LIKELY = 5  # neighbours that tell where a dot with an unclean outline is
_SURE = 8  # neighbours that tell where a hidden dot must be
_SIZE_TOLERANCE = 0.5  # in the logarithm of the radius


@dataclass(frozen=True)
class LostDot:
    """A node whose dot is seen but not measured; `outline` as in `PictureDots`, NaN where it is cut."""

    node: Node
    flag: DotFlag
    seen_at: np.ndarray
    outline: np.ndarray


def lost_dots(
    lattice: Lattice,
    outlines: Outlines,
    blobs: Blobs,
    size: tuple[int, int],
    declared: Callable[[Node], bool],
) -> list[LostDot]:
    """Return the nodes beside the lattice that the frame cuts, that are hidden, or have no clean outline.

    Parameters
    ----------
    lattice, outlines
        What is known.
    blobs : Blobs
        The rough spots of the picture, cut ones among them.
    size : tuple of int
        Width and height of the picture, px.
    declared : callable
        Tells whether a node belongs to the declared grid: only such ones can be hidden.
    """
    span = (-1, 0, 1)
    beside = {(a + i, b + j) for a, b in lattice.spots for i in span for j in span}
    taken = outlines.centre[list(lattice.spots.values())]
    rough = Blobs(blobs.centre[~blobs.cut], blobs.shape[~blobs.cut], blobs.cut[~blobs.cut])
    rough_radii = mean_radius(rough.shape)
    lost = []
    expected = Predictor(lattice, outlines).predict(sorted(beside - lattice.spots.keys()))
    for node, prediction in expected.items():
        radius = float(np.linalg.det(prediction.outline)) ** 0.25
        dot = _cut(node, prediction.position, prediction.outline, blobs, size)
        if dot is None and prediction.neighbours >= _LIKELY:
            dot = _unclean(node, prediction.position, radius, rough, rough_radii)
        sure = declared(node) and prediction.neighbours >= _SURE
        if dot is None and sure and _in_picture(prediction, size):
            dot = LostDot(node, DotFlag.HIDDEN, prediction.position, np.full((2, 2), np.nan))
        if dot is not None and np.linalg.norm(taken - dot.seen_at, axis=1).min() > radius:
            lost.append(dot)
    return lost


def _in_picture(prediction: Prediction, size: tuple[int, int]) -> bool:
    """Tell whether the outline that is expected lies in the picture as a whole."""
    return bool(inside_frame(prediction.position[None], prediction.outline[None], size, 0.0).all())


def _cut(
    node: Node, position: np.ndarray, shape: np.ndarray, blobs: Blobs, size: tuple[int, int]
) -> LostDot | None:
    """Return the dot if the frame cuts the predicted outline and there is a spot in what remains of it."""
    extent = np.sqrt(np.diag(shape))
    last = np.array(size) - 1.0
    low, high = np.maximum(position - extent, 0), np.minimum(position + extent, last)
    whole = (position - extent > _MARGIN - 0.5).all() and (position + extent < last + 0.5 - _MARGIN).all()
    if whole or (high - low < 0).any() or not blobs.cut.any():
        return None
    half = np.sqrt(np.diagonal(blobs.shape[blobs.cut], axis1=1, axis2=2))
    corners = np.concatenate([blobs.centre[blobs.cut] - half, blobs.centre[blobs.cut] + half], axis=1)
    wanted = np.concatenate([low, high])
    miss = np.abs(corners - wanted).max(axis=1) / float(extent.max())
    best = int(miss.argmin())
    if miss[best] > _CUT_MISS:
        return None
    return LostDot(node, DotFlag.CUT, blobs.centre[blobs.cut][best], np.full((2, 2), np.nan))


def _unclean(
    node: Node, position: np.ndarray, radius: float, rough: Blobs, rough_radii: np.ndarray
) -> LostDot | None:
    """Return the dot if there is a whole spot of about its size at its place."""
    if len(rough_radii) == 0:
        return None
    distance = np.linalg.norm(rough.centre - position, axis=1) / radius
    distance[np.abs(np.log(rough_radii / radius)) > _SIZE_TOLERANCE] = np.inf
    best = int(distance.argmin())
    if distance[best] > _NEAR_MISS:
        return None
    return LostDot(node, DotFlag.BAD_FIT, rough.centre[best], rough.shape[best])
