"""Discs beside a grid of equal dots on bare paper: a line of dots would go on where the paper shows none."""

from collections.abc import Sequence

import cv2
import numpy as np

from labcal.detect.checks.missing_dots import UnmeasuredDot
from labcal.detect.grey import GreyPicture
from labcal.detect.lattice.lattice import Node
from labcal.detect.lattice.numbering import AnyNumbering
from labcal.detect.lattice.prediction import Prediction, Predictor
from labcal.detect.outlines.outlines import inside_frame
from labcal.targets.grid import DotGrid

_BARE_SHARE = 0.6
"""Share of a line's places without a dot that must be bare paper."""
_FEWEST_BARE = 2
_LEVEL, _MEAN_LEVEL = 0.05, 0.02
"""Most difference from the paper beside a dot, of the step from dot to paper: anywhere, on average."""
_SIGMAS = 3.0
_SAMPLES = np.linspace(0.0, 1.0, 9)
_CLEAR = 1.5
"""Distance from a dot's middle from which on paper is bare, in radii."""


def dots_of_lines(
    grey: GreyPicture,
    beyond: Sequence[UnmeasuredDot],
    predictor: Predictor,
    numbering: AnyNumbering,
    target: DotGrid,
) -> list[UnmeasuredDot]:
    """Return the dots beyond a grid that may be of a further line: its other places are not bare paper.

    A larger print has dots all along the next line. Something may hide them; but where plain paper is seen at
    most of their places, and on the way there from the grid, there is no such line, and a disc is a mark.

    Parameters
    ----------
    grey : ndarray, shape (h, w)
        The picture, dots dark.
    beyond : sequence of UnmeasuredDot
        What looks like dots around the grid.
    predictor : Predictor
        Of the lattice.
    numbering : AnyNumbering
    target : DotGrid
        One without rings.
    """
    lines: dict[tuple[int, int], list[UnmeasuredDot]] = {}
    for dot in beyond:
        line = _line(numbering.index(dot.node), target)
        if line is not None:
            lines.setdefault(line, []).append(dot)
    kept = []
    for line, dots in lines.items():
        if not _is_bare(grey, line, {dot.node for dot in dots}, predictor, numbering, target):
            kept += dots
    return kept


def _line(place: tuple[int, int], target: DotGrid) -> tuple[int, int] | None:
    """Return axis and number of the line beyond the grid on which a place is; None within it."""
    for axis, count in enumerate((target.cols, target.rows)):
        if not 0 <= place[axis] < count:
            return axis, place[axis]
    return None


def _is_bare(
    grey: GreyPicture,
    line: tuple[int, int],
    dots: set[Node],
    predictor: Predictor,
    numbering: AnyNumbering,
    target: DotGrid,
) -> bool:
    """Tell whether most places of a line that hold no dot show plain paper."""
    axis, number = line
    span = (-1, 0, 1)
    around = {(a + i, b + j) for a, b in predictor.lattice.spots for i in span for j in span}
    empty = sorted(
        node
        for node in around - predictor.lattice.spots.keys() - dots
        if (place := numbering.index(node))[axis] == number
        and 0 <= place[1 - axis] < (target.rows, target.cols)[axis]
    )
    expected = predictor.predict(empty)
    size = (grey.shape[1], grey.shape[0])
    seen = [
        (node, found)
        for node, found in expected.items()
        if bool(inside_frame(found.position[None], found.outline[None], size, 0.0)[0])
    ]
    bare = sum(_shows_paper(grey, node, found, predictor) for node, found in seen)
    return bare >= max(_FEWEST_BARE, _BARE_SHARE * len(empty))


def _shows_paper(grey: GreyPicture, node: Node, found: Prediction, predictor: Predictor) -> bool:
    """Tell whether there is plain paper where a dot would be, and from the nearest dots of the grid to it."""
    spots, outlines = predictor.lattice.spots, predictor.outlines
    near = [
        spots[a, b] for i in (-1, 0, 1) for j in (-1, 0, 1) if (a := node[0] + i, b := node[1] + j) in spots
    ]
    if not near:
        return False
    spot = min(near, key=lambda one: float(np.linalg.norm(outlines.centre[one] - found.position)))
    middle, radius = outlines.centre[spot], float(outlines.radius[spot])
    away = found.position - middle
    length = float(np.linalg.norm(away))
    if length <= _CLEAR * radius:
        return False
    way = middle + (away / length) * (_CLEAR * radius + _SAMPLES[:, None] * (length - _CLEAR * radius))
    turn = 2.0 * np.pi * _SAMPLES[:-1, None]
    disc = found.position + 0.7 * radius * np.hstack([np.cos(turn), np.sin(turn)])
    beside = middle + 1.3 * _CLEAR * radius * np.hstack([np.cos(turn), np.sin(turn)])
    soft = [_levels(grey, places) for places in (way, disc, beside)]
    paper, ink = float(np.percentile(soft[2], 75)), float(_levels(grey, middle[None])[0])
    off = np.abs(np.concatenate(soft[:2]) - paper)
    noise, step = _noise(soft[0]), paper - ink
    even = off.max() < _LEVEL * step + _SIGMAS * noise
    alike = abs(soft[1].mean() - paper) < _MEAN_LEVEL * step + noise
    return bool(step > 0.0 and even and alike)


def _noise(levels: np.ndarray) -> float:
    """Return the standard deviation of levels along a line, by their second differences."""
    return float(np.sqrt(np.mean(np.diff(levels, n=2) ** 2) / 6.0))


def _levels(grey: GreyPicture, places: np.ndarray) -> np.ndarray:
    """Return the grey values at places (n, 2), px."""
    q = places.astype(np.float32)
    values = cv2.remap(grey, q[:, :1], q[:, 1:], cv2.INTER_LINEAR, borderMode=cv2.BORDER_REPLICATE)
    return np.asarray(values[:, 0], dtype=np.float64)
