"""Dots whose outline is another ellipse than the grid's steps make of a dot."""

import numpy as np

from labcal.arrays import Mask
from labcal.detect.lattice.lattice import Lattice
from labcal.detect.lattice.prediction import Predictor
from labcal.detect.matrices import eigenvalues, inverses
from labcal.detect.medians import medians_along
from labcal.detect.outlines.outlines import Outlines
from labcal.detect.settings import DetectSettings
from labcal.detect.stage_settings.grid import GridSettings
from labcal.targets.grid import DotGrid


def deviating_shapes(
    predictor: Predictor, outlines: Outlines, target: DotGrid, settings: DetectSettings
) -> Mask:
    """Tell which of a lattice's spots, in their order, have another shape than the others: hidden in part.

    In units of the grid's steps all dots of a board have one shape, wherever it is seen from.

    Parameters
    ----------
    predictor : Predictor
        Of the lattice.
    outlines : Outlines
        The same spots as the predictor's, of whatever shapes are to be compared.
    target : DotGrid
    settings : DetectSettings
    """
    quality = settings.quality
    interior = predictor.neighbours() >= quality.interior_neighbours
    limit = np.where(interior, quality.max_shape_log, quality.max_rim_shape_log)
    return shape_deviations(predictor, outlines, target, settings.grid) > limit


def without_deviating_shapes(
    lattice: Lattice, outlines: Outlines, target: DotGrid, settings: GridSettings
) -> Predictor:
    """Return a lattice without spots whose shapes deviate very much, as if it skips every other dot.

    It is in its predictor, which knows all predictions already if no spot deviates.
    """
    predictor = Predictor(lattice, outlines, settings)
    deviating = shape_deviations(predictor, outlines, target, settings) > settings.max_lattice_shape_log
    if not deviating.any() or deviating.all():
        return predictor
    kept = {node: spot for (node, spot), out in zip(lattice.spots.items(), deviating, strict=True) if not out}
    return Predictor(Lattice(kept, lattice.undistortion), outlines, settings)


def shape_deviations(
    predictor: Predictor, outlines: Outlines, target: DotGrid, settings: GridSettings
) -> np.ndarray:
    """Return by how much a semi-axis is off, in its logarithm, less what pixels do; 0 if undetermined."""
    spots = predictor.lattice.numbers
    found = predictor.shapes_in_steps(outlines)
    found[outlines.hole[spots] > settings.ring_hole_share] /= target.ring_size**2
    known = np.isfinite(found[:, 0, 0])
    off = np.zeros(len(spots))
    if known.any():
        usual = medians_along(found[known])
        axes = np.sqrt(np.abs(eigenvalues(inverses(usual[None]) @ found[known])))
        minor = np.sqrt(eigenvalues(outlines.shape[spots])[known, 0])
        off[known] = np.abs(np.log(axes)).max(axis=1) - settings.shape_px / minor
    return off
