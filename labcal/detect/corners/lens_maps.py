"""Maps from the picture to the board around corners, as a lens shows these, in powers of the offset."""

from typing import NamedTuple

import numpy as np

from labcal.arrays import Pixels
from labcal.detect.corners.board_lens import BoardLens

_SEEN = 60.0
"""Reach of a map, px, at most; else it is half a square."""
_STENCIL = np.linspace(-1.0, 1.0, 7)
_POWERS = [(order - k, k) for order in range(2, 6) for k in range(order + 1)]
_SECOND, _THIRD = 3, 7
"""Number of terms up to these orders."""
_TAYLOR = np.array([1.0, 1.0, 1.0, 2.0, 2.0, 2.0, 2.0]) * np.array([2.0, 1.0, 2.0, 3.0, 1.0, 1.0, 3.0])
"""Derivatives over the coefficients of the powers."""
BEYOND = len(_POWERS) - _THIRD
"""Terms of fourth and fifth order."""


class LensMaps(NamedTuple):
    """Maps of a lens around n corners, as those of :class:`~labcal.detect.corners.local_maps.LocalMaps`.

    Attributes
    ----------
    linear : ndarray, shape (n, 2, 2)
    perspective : ndarray, shape (n, 2)
    square : ndarray, shape (n, 2, 3)
    cube : ndarray, shape (n, 2, 4)
    beyond : ndarray, shape (n, 2, 11)
        What pixels have to be moved by for these terms to be all, px: of fourth and fifth powers.
    """

    linear: np.ndarray
    perspective: np.ndarray
    square: np.ndarray
    cube: np.ndarray
    beyond: np.ndarray


def lens_maps(lens: BoardLens, q: Pixels) -> LensMaps:
    """Return the maps around places in the picture (n, 2), px, as far as the next half square."""
    place, linear, horizon = lens.on_board(q)
    to_px = np.linalg.inv(linear)
    reach = np.minimum(0.5 * np.linalg.norm(to_px, axis=1).max(axis=1), _SEEN)
    x, y = (grid.ravel() for grid in np.meshgrid(_STENCIL, _STENCIL))
    away = reach[:, None, None] * np.stack([x, y], axis=1)
    seen = lens.on_board((q[:, None] + away).reshape(-1, 2))[0].reshape(away.shape)
    plain = (away @ linear.transpose(0, 2, 1)) / (1.0 + away @ horizon[..., None])
    design = np.stack([x**i * y**j for i, j in _POWERS], axis=1)
    terms = np.linalg.pinv(design) @ (seen - place[:, None] - plain)
    terms = terms.transpose(0, 2, 1) / reach[:, None, None] ** np.array([i + j for i, j in _POWERS])
    taylor = terms[..., :_THIRD] * _TAYLOR
    return LensMaps(
        linear, horizon, taylor[..., :_SECOND], taylor[..., _SECOND:], to_px @ terms[..., _THIRD:]
    )


def moved_beyond(offset: np.ndarray, beyond: np.ndarray) -> np.ndarray:
    """Return offsets (2, n), px, moved by the terms (2, 11) that a map of third order lacks."""
    x, y = offset
    powers = np.stack([x**i * y**j for i, j in _POWERS[_THIRD:]])
    return np.ascontiguousarray(offset + beyond @ powers)
