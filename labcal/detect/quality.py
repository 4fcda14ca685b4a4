"""Stage 4, quality: which dots are measurements."""

from dataclasses import replace

import numpy as np
from jaxtyping import Int64

from labcal.arrays import Mask
from labcal.detect.checks.usual_light import misfits, paleness
from labcal.detect.edge_fit import EdgeFits
from labcal.detect.flagged_dots import FlaggedDots
from labcal.detect.flags import DotFlag
from labcal.detect.lattice.dot_shapes import deviating_shapes
from labcal.detect.lattice.numbering import AnyNumbering
from labcal.detect.lattice.prediction import Predictor
from labcal.detect.medians import median_of
from labcal.detect.outlines.outlines import Outlines, mean_radius
from labcal.detect.settings import DetectSettings
from labcal.detect.stage_settings.quality import QualitySettings
from labcal.targets.grid import DotGrid


def flag_dots(
    fits: EdgeFits,
    predictor: Predictor,
    numbering: AnyNumbering,
    target: DotGrid,
    settings: DetectSettings,
) -> FlaggedDots:
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
    index, spots = numbering.indices(lattice.nodes), outlines.select(lattice.numbers)
    ring = are_rings(index, target)
    dark, light = np.minimum(fits.board, fits.dot), np.maximum(fits.board, fits.dot)
    misfit = misfits(dark, light, fits.variance, limits)
    rough = _is_rough(fits, spots, ring, limits)
    rough |= misfit > np.where(ring, limits.max_ring_misfit_factor, limits.max_misfit_factor)
    rough |= deviating_shapes(predictor, _fitted(fits, predictor), target, settings)
    burnt_out = _is_burnt_out(fits, limits)
    blurred = fits.blur > limits.max_blur_share * mean_radius(fits.shape)
    saturated = fits.ok & (burnt_out | (fits.clipped > limits.max_clipped_share))
    out = ~fits.ok | rough | saturated | blurred
    inside = target.holds_each(index)
    flag = tuple(
        [
            (DotFlag.OK if held else DotFlag.BEYOND_GRID) if not bad else _reason(soft, burnt)
            for held, bad, soft, burnt in zip(
                inside.tolist(), out.tolist(), blurred.tolist(), saturated.tolist(), strict=True
            )
        ]
    )
    centre, covariance = fits.centre.copy(), fits.covariance.copy()
    seen_at, outline = fits.centre.copy(), fits.shape.copy()
    centre[out], covariance[out], misfit[out] = np.nan, np.nan, np.nan
    seen_at[out], outline[out] = spots.centre[out], spots.shape[out]
    named = np.ones(len(index), dtype=bool)
    return FlaggedDots(index, named, flag, seen_at, outline, centre, covariance, misfit)


def _reason(blurred: bool, saturated: bool) -> DotFlag:  # noqa: FBT001 - what is known of a dot
    """Return the flag of a dot that is no measurement."""
    if blurred:
        return DotFlag.BLURRED
    return DotFlag.SATURATED if saturated else DotFlag.BAD_FIT


def are_rings(index: Int64[np.ndarray, "n 2"], target: DotGrid) -> Mask:
    """Tell which places (col, row) are rings of the target."""
    ring = np.zeros(len(index), dtype=bool)
    for col, row in target.ring_indices:
        ring |= (index[:, 0] == col) & (index[:, 1] == row)
    return ring


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
    shape, which = predictor.outlines.shape.copy(), predictor.lattice.numbers
    shape[which] = np.where(fits.ok[:, None, None], fits.shape, shape[which])
    return replace(predictor.outlines, shape=shape)
