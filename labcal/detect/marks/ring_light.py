"""Light of a code ring that blur brings to its dot, and a picture without it."""

from dataclasses import dataclass

import cv2
import numpy as np
from jaxtyping import Bool

from labcal.detect.edge_fit import fit_edges
from labcal.detect.grey import GreyPicture
from labcal.detect.marks.ring_samples import PER_SECTOR, displaced
from labcal.detect.marks.round_dots import lit_centres, sharp_shapes, surrounded_reach
from labcal.detect.outlines.outlines import Outlines, matrix_root
from labcal.detect.settings import DetectSettings
from labcal.geometry.two_by_two import eigenvalues
from labcal.targets.coded_dots import RING_INNER, RING_OUTER

_FINER = 4
"""Samples along a side of a pixel."""
_ROUNDS = 2
_LEAST_BLUR = 0.08
"""Blur over the minor semi-axis below which no light of the ring reaches the band around the outline."""
_PIXEL_VARIANCE = 1.0 / 12.0
_REACH_BLURS = 4.0


@dataclass(frozen=True)
class Ring:
    """A ring that is read.

    Attributes
    ----------
    word : ndarray of bool, shape (sectors,)
        Sectors in the order of the picture, clockwise; true is black.
    start : int
        The sample that the first sector begins with.
    tilt : ndarray, shape (2,)
        Displacement of the circle's centre by perspective, in radii.
    """

    word: Bool[np.ndarray, " sectors"]
    start: int
    tilt: np.ndarray


def without_rings(
    grey: GreyPicture, spots: Outlines, rings: list[Ring], settings: DetectSettings
) -> GreyPicture:
    """Return a picture in which blur brings no light of rings, or no lack of it, to their dots.

    The ring of a coded dot is one radius from its outline. Where blur is a fifth of that or more, black
    sectors darken the paper around the dot on their side, and pull the fit of its edge there: by 0.02 to 0.04
    px at radii of 6 to 10 px. The code and the dot's outline say where the sectors are, so that their share
    is computed and taken away. It depends on the blur, which the fit then knows better: the first fit is
    that of the picture as it is.

    Parameters
    ----------
    grey : ndarray, shape (h, w)
        The picture; it is left as it is.
    spots : Outlines
        The dots.
    rings : list of Ring
        Around each.
    settings : DetectSettings
    """
    reach = surrounded_reach(settings)
    cleared = grey
    for _ in range(_ROUNDS):
        fits = fit_edges(cleared, spots, np.zeros(len(rings)), reach, 0.0, settings.edge)
        with np.errstate(invalid="ignore"):
            minor = np.sqrt(eigenvalues(fits.shape)[:, 0])
            soft = np.flatnonzero(fits.ok & (fits.blur > _LEAST_BLUR * minor) & (fits.blur < minor))
        if not len(soft):
            return cleared
        cleared = grey.copy()
        centres, roots = lit_centres(fits), matrix_root(sharp_shapes(fits))
        for number in soft.tolist():
            light = _Light(
                float(fits.blur[number]),
                float(fits.board[number] - fits.dot[number]),
                fits.light_slope[number],
            )
            _clear(cleared, centres[number], roots[number], light, rings[number])
    return cleared


@dataclass(frozen=True)
class _Light:
    """Blur, px, step from ink to paper at the dot, grey values, and its change, a share a px."""

    blur: float
    step: float
    slope: np.ndarray


def _clear(picture: GreyPicture, centre: np.ndarray, root: np.ndarray, light: _Light, ring: Ring) -> None:
    """Take a ring's share away within its inner edge."""
    extent = np.sqrt(np.diag(root @ root))
    margin = RING_OUTER * (1.0 + float(np.hypot(*ring.tilt))) * extent + _REACH_BLURS * light.blur
    low, high = np.floor(centre - margin).astype(int), np.ceil(centre + margin).astype(int)
    x, y = (
        (np.arange(_FINER * (b - a + 1)) + 0.5) / _FINER - 0.5 + a for a, b in zip(low, high, strict=True)
    )
    q = np.stack(np.broadcast_arrays(x[None, :], y[:, None]), axis=-1)
    flat = (q - centre) @ np.linalg.inv(root).T
    black = _is_black(displaced(flat, -ring.tilt), ring) * np.exp((q - centre) @ light.slope)
    sigma = np.sqrt(max(light.blur**2 - _PIXEL_VARIANCE, 0.01)) * _FINER
    soft = cv2.GaussianBlur(black.astype(np.float32), (0, 0), sigma, borderType=cv2.BORDER_REPLICATE)
    height, width = high[1] - low[1] + 1, high[0] - low[0] + 1
    share = soft.reshape(height, _FINER, width, _FINER).mean(axis=(1, 3))
    first, last = np.maximum(low, 0), np.minimum(high + 1, picture.shape[::-1])
    inner = share[first[1] - low[1] : last[1] - low[1], first[0] - low[0] : last[0] - low[0]]
    picture[first[1] : last[1], first[0] : last[0]] += np.float32(light.step) * inner


def _is_black(flat: np.ndarray, ring: Ring) -> np.ndarray:
    """Tell where a ring is black, in radii of its dot."""
    sectors = len(ring.word)
    rho = np.hypot(flat[..., 0], flat[..., 1])
    turn = np.arctan2(flat[..., 1], flat[..., 0]) / (2.0 * np.pi) * sectors - ring.start / PER_SECTOR
    inside = (rho > RING_INNER) & (rho < RING_OUTER)
    return np.asarray(inside & ring.word[np.floor(turn).astype(int) % sectors])
