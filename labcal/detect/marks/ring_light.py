"""Light of a code ring that blur brings to its dot, and a picture without it."""

from dataclasses import dataclass

import cv2
import numpy as np
from jaxtyping import Bool

from labcal.detect.edge_fit import fit_edges
from labcal.detect.grey import GreyPicture
from labcal.detect.light_fall import lit_centres
from labcal.detect.marks.ring_samples import PER_SECTOR, displaced
from labcal.detect.marks.round_dots import sharp_shapes, surrounded_reach
from labcal.detect.outlines.outlines import Outlines
from labcal.detect.settings import DetectSettings
from labcal.geometry.two_by_two import eigenvalues, matrix_roots
from labcal.targets.coded_dots import RING_INNER, RING_OUTER

_FINER = 4
"""Samples along a side of a pixel."""
_ROUNDS = 2
_LEAST_BLUR = 0.08
"""Blur over the minor semi-axis below which no light of the ring reaches the band around the outline."""
_PIXEL_VARIANCE = 1.0 / 12.0
_REACH_BLURS = 4.0
_LEAST_VARIANCE = 0.01
"""Of the blur, px squared."""
_NEAREST, _FARTHEST = 1.7, 3.4
"""Radii between which the ring is seen."""
_STEP = 0.02
"""Of the perspective, in radii, for derivatives by differences."""
_OUTLYING = 0.3
"""Share of the step from ink to paper by which a pixel departs from a ring that nothing hides, at most."""
_FEWEST = 40
_MOST_CHANGE = 0.15


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
    hidden : ndarray of bool, shape (angles,)
        Samples around the ring at which something hides it that looks otherwise.
    """

    word: Bool[np.ndarray, " sectors"]
    start: int
    tilt: np.ndarray
    hidden: Bool[np.ndarray, " angles"]


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
        centres, roots = lit_centres(fits), matrix_roots(sharp_shapes(fits))
        for number in soft.tolist():
            light = _Light(
                float(fits.blur[number]),
                float(fits.board[number]),
                float(fits.dot[number]),
                fits.light_slope[number],
            )
            _clear(cleared, (centres[number], roots[number]), light, rings[number])
    return cleared


@dataclass(frozen=True)
class _Light:
    """Blur, px, levels of board and dot, grey values, and the change of light, a share a px."""

    blur: float
    board: float
    dot: float
    slope: np.ndarray


class _Window:
    """The pixels of a mark, and the share of its ring's ink in each."""

    def __init__(
        self, picture: GreyPicture, ellipse: tuple[np.ndarray, np.ndarray], light: _Light, ring: Ring
    ) -> None:
        centre, root = ellipse
        extent = RING_OUTER * (1.0 + float(np.hypot(*ring.tilt))) * np.sqrt(np.diag(root @ root))
        margin = extent + _REACH_BLURS * light.blur
        low, high = np.floor(centre - margin).astype(int), np.ceil(centre + margin).astype(int) + 1
        x, y = (
            (np.arange(_FINER * (b - a)) + 0.5) / _FINER - 0.5 + a for a, b in zip(low, high, strict=True)
        )
        away = np.stack(np.broadcast_arrays(x[None, :], y[:, None]), axis=-1) - centre
        self._flat = away @ np.linalg.inv(root).T
        self._fine = np.exp(away @ light.slope)
        self._sigma = float(np.sqrt(max(light.blur**2 - _PIXEL_VARIANCE, _LEAST_VARIANCE))) * _FINER
        self._ring = ring
        first, last = np.maximum(low, 0), np.minimum(high, picture.shape[::-1])
        self.place = slice(first[1], last[1]), slice(first[0], last[0])
        self._inner = (
            slice(first[1] - low[1], last[1] - low[1]),
            slice(first[0] - low[0], last[0] - low[0]),
        )
        self.rho = self._pixels(np.hypot(self._flat[..., 0], self._flat[..., 1]))
        self.light = self._pixels(self._fine)

    def _pixels(self, fine: np.ndarray) -> np.ndarray:
        """Return means over pixels that are in the picture."""
        height, width = fine.shape
        mean = fine.reshape(height // _FINER, _FINER, width // _FINER, _FINER).mean(axis=(1, 3))
        return np.asarray(mean[self._inner])

    def share(self, tilt: np.ndarray) -> np.ndarray:
        """Return the blurred ink of the ring times the light, with a perspective."""
        black = _is_black(displaced(self._flat, -tilt), self._ring) * self._fine
        soft = cv2.GaussianBlur(
            black.astype(np.float32), (0, 0), self._sigma, borderType=cv2.BORDER_REPLICATE
        )
        return self._pixels(soft)


def _clear(picture: GreyPicture, ellipse: tuple[np.ndarray, np.ndarray], light: _Light, ring: Ring) -> None:
    """Take a ring's share away."""
    window = _Window(picture, ellipse, light, ring)
    seen = picture[window.place]
    tilt = _settled(window, seen, light, ring.tilt)
    seen += ((light.board - light.dot) * window.share(tilt)).astype(np.float32)


def _settled(window: _Window, seen: np.ndarray, light: _Light, tilt: np.ndarray) -> np.ndarray:
    """Return the perspective with which the ring is as it is seen, by Gauss-Newton.

    Names are read with a rough one. But the ring's distance from the dot on either side depends on it: its
    centre is displaced by the eccentricity times six or so.
    """
    step = light.board - light.dot
    dark = light.board * window.light - seen
    annulus = (window.rho > _NEAREST) & (window.rho < _FARTHEST)
    for _ in range(_ROUNDS):
        share = window.share(tilt)
        off = dark - step * share
        used = annulus & (np.abs(off) < _OUTLYING * step)
        if used.sum() < _FEWEST:
            return tilt
        J = np.stack(
            [step * (window.share(tilt + d) - share)[used] / _STEP for d in _STEP * np.eye(2)], axis=-1
        )
        change = np.linalg.lstsq(J, off[used], rcond=None)[0]
        if not np.hypot(*change) < _MOST_CHANGE:
            return tilt
        tilt = tilt + change
    return tilt


def _is_black(flat: np.ndarray, ring: Ring) -> np.ndarray:
    """Tell where a ring is black and in sight, in radii of its dot."""
    angles = len(ring.hidden)
    rho = np.hypot(flat[..., 0], flat[..., 1])
    turn = np.arctan2(flat[..., 1], flat[..., 0]) / (2.0 * np.pi) * angles
    sector = np.floor((turn - ring.start) / PER_SECTOR).astype(int) % len(ring.word)
    inside = (rho > RING_INNER) & (rho < RING_OUTER) & ~ring.hidden[np.floor(turn).astype(int) % angles]
    return np.asarray(inside & ring.word[sector])
