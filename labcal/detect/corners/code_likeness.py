"""Likeness of squares in a picture to the codes of a dictionary, without reading any code alone."""

from dataclasses import dataclass
from functools import lru_cache

import cv2
import numpy as np
from jaxtyping import Float64

from labcal.detect.grey import GreyPicture
from labcal.detect.lattice.rings import TURNS
from labcal.geometry.projective_map import homogeneous, projective_map
from labcal.targets.charuco import CharucoBoard, MarkerDictionary
from labcal.targets.charuco_opencv import opencv_dictionary

_MOST_CODES = 250
"""Codes of a dictionary that chance is judged by."""
_OFFSETS = (-0.2, 0.0, 0.2)
"""Samples of a cell along either axis, in cells from its middle."""
_UNIT = np.array([[0.0, 0.0], [1.0, 0.0], [1.0, 1.0], [0.0, 1.0]])


@dataclass(frozen=True)
class CodeLikeness:
    """Correlations of squares with codes.

    Attributes
    ----------
    cells : ndarray, shape (n, cells, cells)
        Brightness of the cells of squares, by column and row of the lattice, in steps from black to white,
        without that which squares have in common.
    mean, deviation : ndarray, shape (n,)
        Of the correlation of each square with the codes of the dictionary in all four turns: what a code that
        is not the square's gives.
    """

    cells: Float64[np.ndarray, "n cells cells"]
    mean: Float64[np.ndarray, " n"]
    deviation: Float64[np.ndarray, " n"]

    @classmethod
    def of(cls, cells: Float64[np.ndarray, "n cells cells"], dictionary: MarkerDictionary) -> "CodeLikeness":
        """Return the likeness of squares, by their cells as they are seen, in steps from black to white.

        The black border darkens the outer cells of every square alike, in all four turns; that is left out.
        """
        plain = cells - cells.mean(axis=(1, 2), keepdims=True)
        common = plain.mean(axis=0)
        common = np.mean([np.rot90(common, turn) for turn in range(4)], axis=0)
        plain = np.clip(plain - common, -1.0, 1.0)
        codes = _codes(dictionary)
        every = np.concatenate([np.rot90(codes, turn, axes=(1, 2)) for turn in range(4)])
        chance = np.einsum("nij,kij->nk", plain, every)
        return cls(plain, chance.mean(axis=1), chance.std(axis=1))

    def sigmas(
        self, squares: np.ndarray, codes: Float64[np.ndarray, "m cells cells"]
    ) -> Float64[np.ndarray, " m"]:
        """Return how far some squares are more like given codes than by chance, each in its deviations."""
        correlation = np.einsum("nij,nij->n", self.cells[squares], codes)
        return np.asarray((correlation - self.mean[squares]) / np.maximum(self.deviation[squares], 1e-12))


def seen_cells(
    grey: GreyPicture,
    quads: Float64[np.ndarray, "n 4 2"],
    steps: Float64[np.ndarray, " n"],
    board: CharucoBoard,
) -> Float64[np.ndarray, "n cells cells"]:
    """Return the brightness of the cells of markers in squares, by column and row, in steps.

    Parameters
    ----------
    grey : ndarray, shape (h, w)
    quads : ndarray, shape (n, 4, 2)
        Corners of each square, px: the first one, the next ones along its first axis, opposite, and along its
        second axis.
    steps : ndarray, shape (n,)
        From black to white at each square, grey values.
    board : CharucoBoard
    """
    count = _codes(board.dictionary).shape[1]
    side = board.marker_mm / board.square_mm / (count + 2)
    middles = board.corner_gap + side * (np.arange(count) + 1.5)
    x, y = np.meshgrid(middles, middles, indexing="ij")
    cells = np.zeros((len(quads), count, count))
    for n, quad in enumerate(quads):
        H = projective_map("square", _UNIT, quad)
        for dx in _OFFSETS:
            for dy in _OFFSETS:
                places = np.stack([x + side * dx, y + side * dy], axis=-1).reshape(-1, 2)
                xyw = homogeneous(places) @ H.T
                q = (xyw[:, :2] / xyw[:, 2:]).astype(np.float32)
                values = cv2.remap(
                    grey, q[:, None, 0], q[:, None, 1], cv2.INTER_LINEAR, borderMode=cv2.BORDER_REPLICATE
                )
                cells[n] += values.reshape(count, count) / len(_OFFSETS) ** 2
        cells[n] /= steps[n]
    return cells


def board_codes(board: CharucoBoard) -> Float64[np.ndarray, "n cells cells"]:
    """Return the codes of a board's markers, 1 where white, -1 where black, by column and row from below."""
    return _of_ids(board.dictionary, np.arange(board.first_id, board.first_id + board.marker_count))


def turned_codes(
    codes: Float64[np.ndarray, "n cells cells"], turn: int
) -> Float64[np.ndarray, "n cells cells"]:
    """Return codes as they are seen along the axes of a lattice that a turn takes to the board."""
    count = codes.shape[1]
    middle = 0.5 * (count - 1)
    at = np.stack(np.meshgrid(np.arange(count), np.arange(count), indexing="ij"), axis=-1) - middle
    i, j = np.moveaxis(np.rint(at @ TURNS[turn].T + middle).astype(np.int64), -1, 0)
    return codes[:, i, j]


@lru_cache(maxsize=8)
def _codes(dictionary: MarkerDictionary) -> Float64[np.ndarray, "n cells cells"]:
    return _of_ids(dictionary, np.arange(min(dictionary.size, _MOST_CODES)))


def _of_ids(dictionary: MarkerDictionary, ids: np.ndarray) -> Float64[np.ndarray, "n cells cells"]:
    """Return codes, 1 where white and -1 where black, by column and by row from below."""
    made = opencv_dictionary(dictionary)
    cells = made.markerSize + 2
    drawn = [made.generateImageMarker(int(one), cells, borderBits=1)[1:-1, 1:-1] for one in ids]
    return np.stack([np.where(one[::-1].T > 0, 1.0, -1.0) for one in drawn])
