"""Stage 4, quality: which dots are measurements."""

from dataclasses import replace
from typing import NamedTuple

import numpy as np

from labcal.arrays import Mask
from labcal.detect.checks.usual_light import misfits, paleness
from labcal.detect.edge_fit import EdgeFits
from labcal.detect.flags import DotFlag
from labcal.detect.lattice.dot_shapes import deviating_shapes
from labcal.detect.lattice.numbering import AnyNumbering
from labcal.detect.lattice.prediction import Predictor
from labcal.detect.matrices import eigenvalues
from labcal.detect.medians import median_of
from labcal.detect.outlines.outlines import Outlines
from labcal.detect.settings import DetectSettings
from labcal.detect.stage_settings.quality import QualitySettings
from labcal.targets.grid import DotGrid


class FlaggedDot(NamedTuple):
    """One dot on its way into `PictureDots`; its `place` is (col, row), centre and covariance are in px."""

    place: tuple[int, int] | None
    flag: DotFlag
    seen_at: np.ndarray
    outline: np.ndarray
    centre: np.ndarray | None = None
    covariance: np.ndarray | None = None
    misfit: float = np.nan


def flag_dots(
    fits: EdgeFits,
    predictor: Predictor,
    numbering: AnyNumbering,
    target: DotGrid,
    settings: DetectSettings,
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
    settings : DetectSettings
    """
    limits = settings.quality
    lattice, outlines = predictor.lattice, predictor.outlines
    index = [numbering.index(node) for node in lattice.spots]
    spots = outlines.select(np.array(list(lattice.spots.values())))
    rings = target.ring_indices
    ring = np.array([place in rings for place in index])
    dark, light = np.minimum(fits.board, fits.dot), np.maximum(fits.board, fits.dot)
    misfit = misfits(dark, light, fits.variance, limits)
    rough = _is_rough(fits, spots, ring, limits)
    rough |= misfit > np.where(ring, limits.max_ring_misfit_factor, limits.max_misfit_factor)
    rough |= deviating_shapes(predictor, _fitted(fits, predictor), target, settings)
    burnt_out = _is_burnt_out(fits, limits)
    minor = np.sqrt(eigenvalues(spots.shape)[:, 0])
    blurred = (spots.blur > limits.max_blur_share * minor).tolist()
    saturated = (fits.ok & (burnt_out | (fits.clipped > limits.max_clipped_share))).tolist()
    bad = (~fits.ok | rough).tolist()
    dots = []
    for number, (place, off) in enumerate(zip(index, misfit.tolist(), strict=True)):
        if blurred[number] or saturated[number] or bad[number]:
            flag = DotFlag.BAD_FIT
            if blurred[number]:
                flag = DotFlag.BLURRED
            elif saturated[number]:
                flag = DotFlag.SATURATED
            dots.append(FlaggedDot(place, flag, spots.centre[number], spots.shape[number]))
            continue
        flag = DotFlag.OK if target.holds(*place) else DotFlag.BEYOND_GRID
        centre = fits.centre[number]
        measured = (centre, fits.covariance[number], off)
        dots.append(FlaggedDot(place, flag, centre, fits.shape[number], *measured))
    return dots


def _is_rough(fits: EdgeFits, spots: Outlines, ring: np.ndarray, limits: QualitySettings) -> Mask:
    """Tell which outlines are further from their ellipses, and which dots paler, than the others are.

    A print may be ragged, and a renderer's discs are polygons; rings lighten with their holes, so they may.
    """
    usual = median_of(fits.departure[fits.ok]) if fits.ok.any() else 0.0
    farthest = limits.departure_factor * usual + limits.departure_share * spots.radius
    pale = paleness(fits.board, fits.dot, limits) > limits.max_paleness_share
    rough: Mask = (fits.departure > farthest) | (pale & ~ring)
    return rough


def _is_burnt_out(fits: EdgeFits, limits: QualitySettings) -> bool:
    """Tell whether what is bright is clipped, and most edges cut off with it.

    A drawn picture may be as white as white can be, but its edges are whole.
    """
    if not fits.ok.any():
        return False
    burnt, profile = median_of(fits.burnt[fits.ok]), median_of(fits.profile[fits.ok])
    return bool(burnt > limits.burnt_share and profile > limits.burnt_profile_share)


def _fitted(fits: EdgeFits, predictor: Predictor) -> Outlines:
    """Return the outlines with the fitted shapes where there are some."""
    shape, which = predictor.outlines.shape.copy(), list(predictor.lattice.spots.values())
    shape[which] = np.where(fits.ok[:, None, None], fits.shape, shape[which])
    return replace(predictor.outlines, shape=shape)
