"""Ids of the tags of an AprilGrid, by the correlation of their cells with all codes of the set, blurred."""

from dataclasses import dataclass
from functools import lru_cache

import cv2
import numpy as np
from jaxtyping import Float64
from scipy.special import ndtr, stdtrit

from labcal.detect.corners.saddles import Saddles
from labcal.detect.corners.tag_quads import black_squares, square_levels
from labcal.detect.grey import GreyPicture
from labcal.detect.medians import DEVIATIONS_A_MAD
from labcal.targets.april_grid import AprilGrid
from labcal.targets.charuco import MarkerDictionary
from labcal.targets.charuco_opencv import opencv_dictionary

_BLURS = (0.2, 0.45, 0.65)
"""Standard deviations of the blur that codes are looked for with, in cells."""
_CHANCE = 1e-4
"""Probability that a square with cells at random, within a black border, is taken for a tag of the set."""
_LEAST_CONTRAST = 4.0
"""Between black and white cells, in the standard deviations of either."""
_MOST_WRONG_BORDER = 0.06
"""Share of the border's cells that may be white: something small over them."""
_WHITE = 90.0
"""Percentile of the inner cells that is as bright as white, as the paper beside the tag is."""
_TURNS = 4
_OTHER_BORDER = {1: 2, 2: 1}


@dataclass(frozen=True)
class SeenTags:
    """Tags that are read in a picture.

    Attributes
    ----------
    number : ndarray of int, shape (n,)
        Their ids.
    corners : ndarray, shape (n, 4, 2)
        px, anticlockwise on the print from the lower left one.
    """

    number: np.ndarray
    corners: Float64[np.ndarray, "n 4 2"]


@dataclass(frozen=True)
class TagCodes:
    """The codes of a set of tags as they are seen.

    Attributes
    ----------
    size : int
        Cells along a side of a code.
    patterns : ndarray, shape (m, size * size)
        Cells of every code in each of four orientations and with every blur, less their mean, of norm 1.
    turns : ndarray of int, shape (m, 2)
        Number of the code, and its quarter turns as OpenCV counts them.
    least : float
        Correlation that cells at random reach with one of them with a probability of 1 in 10,000.
    """

    size: int
    patterns: np.ndarray
    turns: np.ndarray
    least: float

    def likeness(self, levels: Float64[np.ndarray, "n cells cells"], border: int) -> np.ndarray:
        """Return the correlations of the cells of squares within a border with all patterns, shape (n, m)."""
        inner = levels[:, border:-border, border:-border].reshape(len(levels), self.size**2)
        return np.asarray(_normal(inner) @ self.patterns.T)


@lru_cache(maxsize=8)
def tag_codes(dictionary: MarkerDictionary, border: int) -> TagCodes:
    """Return the codes of a set of tags with a black border of so many cells.

    The correlation r of n random cells with a pattern has Student's distribution, ``r sqrt((n - 2) / (1 -
    r^2))`` with n - 2 degrees of freedom; Bonferroni's bound holds for all patterns together.
    """
    known = opencv_dictionary(dictionary)
    size = int(known.markerSize)
    bits = np.stack(
        [cv2.aruco.Dictionary.getBitsFromByteList(one[None], size) for one in np.asarray(known.bytesList)]
    ).astype(np.float64)
    at = np.arange(size + 2 * border)
    patterns, turns = [], []
    for turn in range(_TURNS):
        turned = np.pad(np.rot90(bits, turn, axes=(1, 2)), ((0, 0), (border, border), (border, border)))
        for blur in _BLURS:
            away = (at[border:-border, None] - at[None]) / blur
            spread = ndtr(away + 0.5 / blur) - ndtr(away - 0.5 / blur)
            patterns.append(np.einsum("ij,njk,lk->nil", spread, turned, spread).reshape(len(bits), -1))
            turns.append(np.stack([np.arange(len(bits)), np.full(len(bits), turn)], axis=1))
    every = np.concatenate(patterns)
    freedom = size * size - 2
    t = -float(stdtrit(freedom, _CHANCE / len(every)))
    return TagCodes(size, _normal(every), np.concatenate(turns), t / float(np.sqrt(freedom + t * t)))


def read_tags(grey: GreyPicture, saddles: Saddles, grid: AprilGrid) -> SeenTags:
    """Return the tags of a grid's set between saddle points of a picture.

    Cells are compared with the codes as a blurred picture shows them: a threshold loses single white cells.

    Parameters
    ----------
    grey : ndarray, shape (h, w)
    saddles : Saddles
        Of the picture.
    grid : AprilGrid
        Its set of tags and their border count alone.
    """
    codes, border = tag_codes(grid.dictionary, grid.border_cells), grid.border_cells
    other_codes = tag_codes(grid.dictionary, _OTHER_BORDER[border])
    quads = black_squares(saddles)
    levels = square_levels(grey, quads, codes.size + 2 * border)
    quads, levels = (every[_has_border(levels, border)] for every in (quads, levels))
    likeness = codes.likeness(levels, border)
    sure = np.flatnonzero(likeness.max(axis=1, initial=0.0) >= codes.least)
    quads, likeness = quads[sure], likeness[sure]
    # Cells that are counted wrongly resemble their own code a little less.
    other = square_levels(grey, quads, codes.size + 2 * _OTHER_BORDER[border])
    own = likeness.max(axis=1, initial=0.0) > other_codes.likeness(other, _OTHER_BORDER[border]).max(
        axis=1, initial=0.0
    )
    number, turn = codes.turns[likeness[own].argmax(axis=1)].T
    # OpenCV counts quarter turns of its own picture of the tag, half a turn from Kalibr's print.
    order = (np.arange(_TURNS) + turn[:, None] + 2) % _TURNS
    return SeenTags(number, np.take_along_axis(quads[own], order[..., None], axis=1))


def _normal(cells: np.ndarray) -> np.ndarray:
    """Return rows of cells less their mean, of norm 1; zeros where all are alike."""
    away = cells - cells.mean(axis=1, keepdims=True)
    norm = np.linalg.norm(away, axis=1, keepdims=True)
    return np.asarray(away / np.where(norm > 0.0, norm, 1.0))


def _has_border(levels: Float64[np.ndarray, "n cells cells"], border: int) -> np.ndarray:
    """Tell which squares have a black border around cells of which some are white."""
    inner = np.zeros(levels.shape[1:], dtype=bool)
    inner[border:-border, border:-border] = True
    if not len(levels):
        return np.zeros(0, dtype=bool)
    ring = levels[:, ~inner]
    black, white = np.median(ring, axis=1), np.percentile(levels[:, inner], _WHITE, axis=1)
    spread = DEVIATIONS_A_MAD * np.median(np.abs(ring - black[:, None]), axis=1)
    wrong = (ring > 0.5 * (black + white)[:, None]).mean(axis=1)
    return np.asarray(
        (white - black >= _LEAST_CONTRAST * spread) & (white > black) & (wrong <= _MOST_WRONG_BORDER)
    )
