"""Dots that are in the picture, and whose place in the grid is known, but that cannot be measured."""

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np
from jaxtyping import Int64

from labcal.arrays import PixelCovariances, Pixels
from labcal.detect.flags import DotFlag
from labcal.detect.lattice.beside import distance_to_nearest, empty_beside, nearest_alike
from labcal.detect.lattice.lattice import Node
from labcal.detect.lattice.prediction import Predictor
from labcal.detect.outlines.blobs import Blobs
from labcal.detect.outlines.outlines import inside_frame, mean_radius
from labcal.detect.stage_settings.quality import QualitySettings


@dataclass(frozen=True)
class UnmeasuredDot:
    """A node whose dot is seen but not measured; `outline` as in `PictureDots`, NaN where it is cut."""

    node: Node
    flag: DotFlag
    seen_at: np.ndarray
    outline: np.ndarray


def unmeasured_dots(
    predictor: Predictor,
    blobs: Blobs,
    size: tuple[int, int],
    declared: Callable[[Node], bool],
    settings: QualitySettings,
) -> list[UnmeasuredDot]:
    """Return the nodes beside the lattice that the frame cuts, that are hidden, or have no clean outline.

    Parameters
    ----------
    predictor : Predictor
        Of the lattice.
    blobs : Blobs
        The rough spots of the picture, cut ones among them.
    size : tuple of int
        Width and height of the picture, px.
    declared : callable
        Returns whether a node belongs to the declared grid: only such ones can be hidden.
    settings : QualitySettings
    """
    beside = empty_beside(predictor.lattice.nodes)
    known, _, position, _, shape, neighbours = predictor.predicted(beside)
    if len(known) == 0:
        return []
    nodes: list[Node] = [(int(a), int(b)) for a, b in beside[known].tolist()]
    cut = _cut(position, shape, blobs, size, settings)
    limits = settings.unclean_radius_log, settings.unclean_residual_radii
    unclean = nearest_alike(position, shape, (blobs.centre, blobs.shape, blobs.cut), limits)
    unclean[neighbours < settings.unclean_neighbours] = -1
    in_picture = inside_frame(position, shape, size, 0.0) & (neighbours >= settings.hidden_neighbours)
    nothing = np.full((2, 2), np.nan)
    unmeasured = []
    for k, node in enumerate(nodes):
        if cut[k] >= 0:
            unmeasured.append(UnmeasuredDot(node, DotFlag.CUT, blobs.centre[cut[k]], nothing))
        elif unclean[k] >= 0:
            spot = unclean[k]
            unmeasured.append(UnmeasuredDot(node, DotFlag.BAD_FIT, blobs.centre[spot], blobs.shape[spot]))
        elif in_picture[k] and declared(node):
            unmeasured.append(UnmeasuredDot(node, DotFlag.HIDDEN, position[k], nothing))
    if not unmeasured:
        return []
    taken = predictor.outlines.centre[predictor.lattice.numbers]
    away = distance_to_nearest(np.array([dot.seen_at for dot in unmeasured]), taken).tolist()
    radius = dict(zip(nodes, mean_radius(shape).tolist(), strict=True))
    return [dot for dot, far in zip(unmeasured, away, strict=True) if far > radius[dot.node]]


def _cut(
    position: Pixels,
    shape: PixelCovariances,
    blobs: Blobs,
    size: tuple[int, int],
    settings: QualitySettings,
) -> Int64[np.ndarray, " n"]:
    """Return the spots in what remains of outlines that the frame cuts; -1 where there is none."""
    spots = np.flatnonzero(blobs.cut)
    found = np.full(len(position), -1)
    extent = np.sqrt(np.diagonal(shape, axis1=1, axis2=2))
    low, high = np.maximum(position - extent, 0), np.minimum(position + extent, np.array(size) - 1.0)
    crossed = ~inside_frame(position, shape, size, 0.5 - settings.cut_margin_px) & (high >= low).all(axis=1)
    if len(spots) == 0 or not crossed.any():
        return found
    half = np.sqrt(np.diagonal(blobs.shape[spots], axis1=1, axis2=2))
    corners = np.concatenate([blobs.centre[spots] - half, blobs.centre[spots] + half], axis=1)
    wanted = np.concatenate([low, high], axis=1)[crossed]
    residual = np.abs(corners - wanted[:, None]).max(axis=2) / extent[crossed].max(axis=1)[:, None]
    best = residual.argmin(axis=1)
    found[crossed] = np.where(residual.min(axis=1) <= settings.cut_residual_radii, spots[best], -1)
    return found
