"""Stage 4, quality: which dots are measurements, and whether a picture as a whole is to be used."""

from dataclasses import dataclass, replace

import numpy as np

from labcal.arrays import Mask
from labcal.detect.dots import PictureDots
from labcal.detect.edge_fit import EdgeFits
from labcal.detect.flags import SPOILT, DotFlag, Refusal
from labcal.detect.grey import GreyPicture, clipping
from labcal.detect.lattice.numbering import AnyNumbering
from labcal.detect.lattice.prediction import Predictor
from labcal.detect.lattice.shapes import odd_shapes
from labcal.detect.outlines.outlines import Outlines
from labcal.geometry.two_by_two import eigenvalues
from labcal.targets.grid import DotGrid

# An outline further from its ellipse is not measured: times the usual departure of the picture's dots (a
# print may be ragged, a renderer's discs are polygons), and of the radius.
_DEPARTURE = (2.5, 0.001)
_BLURRED = 0.6  # of the minor axis
_CLIPPED = 0.06
_MISFIT, _RING_MISFIT = (
    1.5,
    2.0,
)  # of the usual noise; clean dots of the photographs reach 1.4, and small rings,
# whose holes shine into the fit, 1.6
_PALE = 0.2  # of the step; what hides part of a small dot. Rings lighten with their holes, so they may
_USABLE = 0.1  # of the dots that are whole in the picture; what is left where fewer fit is left by chance
_CLIPPED_PICTURE = 0.5
_SOFT, _SOFT_PX = 0.2, 1.5  # of the minor axis, and px: rings lose their holes
_FEWEST_DOTS = 9
_CAUSED = (Refusal.NO_DOTS, Refusal.TOO_FEW_DOTS, Refusal.NO_GRID, Refusal.NO_RINGS)


@dataclass(frozen=True)
class FlaggedDot:
    """One dot on its way into `PictureDots`; centre and covariance (px) only where it is measured."""

    index: tuple[int, int] | None
    flag: DotFlag
    seen_at: np.ndarray
    outline: np.ndarray
    centre: np.ndarray | None = None
    covariance: np.ndarray | None = None
    misfit: float = np.nan


def flag_dots(
    fits: EdgeFits, predictor: Predictor, numbering: AnyNumbering, target: DotGrid
) -> list[FlaggedDot]:
    """Return the dots of a lattice, each with the flag that its fit earns.

    Parameters
    ----------
    fits : EdgeFits
        Of the lattice's spots, in their order.
    predictor : Predictor
        Of the lattice.
    numbering : AnyNumbering
    target : DotGrid
    """
    lattice, outlines = predictor.lattice, predictor.outlines
    index = [numbering.index(node) for node in lattice.spots]
    spots = outlines.select(np.array(list(lattice.spots.values())))
    ring = np.array([place in target.ring_indices for place in index])
    rough = _is_rough(fits, spots, ring) | odd_shapes(predictor, _fitted(fits, predictor), target)
    minor = np.sqrt(eigenvalues(spots.shape)[:, 0])
    dots = []
    for number, place in enumerate(index):
        seen_at, outline = spots.centre[number], spots.shape[number]
        if spots.blur[number] > _BLURRED * minor[number]:
            dots.append(FlaggedDot(place, DotFlag.BLURRED, seen_at, outline))
        elif fits.ok[number] and (fits.burnt_out or fits.clipped[number] > _CLIPPED):
            dots.append(FlaggedDot(place, DotFlag.SATURATED, seen_at, outline))
        elif not fits.ok[number] or rough[number]:
            dots.append(FlaggedDot(place, DotFlag.BAD_FIT, seen_at, outline))
        else:
            flag = DotFlag.OK if target.holds(*place) else DotFlag.BEYOND_GRID
            centre = fits.centre[number]
            told = (centre, fits.covariance[number], float(fits.misfit[number]))
            dots.append(FlaggedDot(place, flag, centre, fits.shape[number], *told))
    return dots


def _is_rough(fits: EdgeFits, spots: Outlines, ring: np.ndarray) -> Mask:
    """Tell which fits leave more than the other dots' do: of the outline, the noise or the darkness."""
    usual = float(np.median(fits.departure[fits.ok])) if fits.ok.any() else 0.0
    rough: Mask = fits.departure > _DEPARTURE[0] * usual + _DEPARTURE[1] * spots.radius
    rough |= (fits.misfit > np.where(ring, _RING_MISFIT, _MISFIT)) | ((fits.paleness > _PALE) & ~ring)
    return rough


def _fitted(fits: EdgeFits, predictor: Predictor) -> Outlines:
    """Return the outlines with the fitted shapes where there are some."""
    shape, which = predictor.outlines.shape.copy(), list(predictor.lattice.spots.values())
    shape[which] = np.where(fits.ok[:, None, None], fits.shape, shape[which])
    return replace(predictor.outlines, shape=shape)


def cause(refusal: Refusal, grey: GreyPicture, outlines: Outlines) -> Refusal:
    """Return what is behind there being no dots or no grid, where the picture tells."""
    if refusal not in _CAUSED:
        return refusal
    low, high = clipping(grey)
    clipped = np.count_nonzero(grey <= low) + np.count_nonzero(grey >= high)
    if low < high and clipped > _CLIPPED_PICTURE * grey.size:
        return Refusal.SATURATED
    minor = np.sqrt(eigenvalues(outlines.shape)[:, 0])
    blur = outlines.blur
    blurred = len(minor) >= _FEWEST_DOTS and np.median(blur / minor) > _SOFT and np.median(blur) > _SOFT_PX
    return Refusal.BLURRED if blurred else refusal


def hardly_measured(dots: PictureDots) -> bool:
    """Tell whether hardly any of the dots that are whole in the picture could be measured."""
    usable = int(dots.ok.sum())
    whole = usable + sum(flag in SPOILT for flag in dots.flag)
    return usable == 0 or usable < _USABLE * whole
