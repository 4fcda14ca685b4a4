"""Stage 2, the grid: from outlines to a lattice whose nodes are numbered, or the reason why there is none."""

from dataclasses import dataclass

import numpy as np

from labcal.detect.flags import Refusal
from labcal.detect.lattice.dot_shapes import without_deviating_shapes
from labcal.detect.lattice.lattice import Lattice, find_lattices
from labcal.detect.lattice.marks_beside import without_marks_beside
from labcal.detect.lattice.numbering import AnyNumbering, number_lattice, numbering_refusal
from labcal.detect.lattice.prediction import Predictor
from labcal.detect.lattice.rough_undistortion import NONE, RoughUndistortion, fisheyes
from labcal.detect.lattice.smoothness import is_smooth, is_smooth_through_fisheye
from labcal.detect.outlines.outlines import Outlines
from labcal.detect.stage_settings.grid import GridSettings
from labcal.targets.grid import DotGrid


@dataclass(frozen=True)
class Grid:
    """A lattice whose nodes are numbered; its spots refer to the outlines that it was found among."""

    predictor: Predictor
    """Of the lattice."""
    numbering: AnyNumbering

    @property
    def lattice(self) -> Lattice:
        """The lattice."""
        return self.predictor.lattice

    @property
    def spots(self) -> np.ndarray:
        """Numbers of the outlines that are dots of the grid."""
        return self.lattice.numbers


def find_grid(
    outlines: Outlines, target: DotGrid, size: tuple[int, int], settings: GridSettings
) -> Grid | Refusal:
    """Return the grid that can be numbered, with the lens that shows most of it.

    Parameters
    ----------
    outlines : Outlines
        Candidates that lie whole in the picture.
    target : DotGrid
    size : tuple of int
        Width and height of the picture, px.
    settings : GridSettings
    """
    best = _find_through(NONE, outlines, target, size, settings)
    few = len(outlines.centre) < settings.min_dots
    if few or best is Refusal.SEVERAL_TARGETS or _is_complete(best, outlines, settings):
        return best
    for lens in fisheyes(size, settings.fisheye_fields_deg):
        other = _find_through(lens, outlines, target, size, settings)
        if not isinstance(other, Refusal) and (
            isinstance(best, Refusal) or len(other.spots) > len(best.spots)
        ):
            best = other
            if _is_complete(best, outlines, settings):
                break
    return best


def _is_complete(grid: Grid | Refusal, outlines: Outlines, settings: GridSettings) -> bool:
    """Tell whether a grid holds nearly every spot that is as large as its dots."""
    if isinstance(grid, Refusal):
        return False
    radius = outlines.radius
    known = radius[grid.spots]
    spare = settings.similar_radius_share
    alike = (radius > (1.0 - spare) * known.min()) & (radius < (1.0 + spare) * known.max())
    return len(known) >= settings.complete_share * int(alike.sum())


def _find_through(
    lens: RoughUndistortion,
    seen: Outlines,
    target: DotGrid,
    size: tuple[int, int],
    settings: GridSettings,
) -> Grid | Refusal:
    """Return the one lattice that can be numbered in the picture of a lens."""
    if len(seen.centre) == 0:
        return Refusal.NO_DOTS
    if len(seen.centre) < settings.min_dots:
        return Refusal.TOO_FEW_DOTS
    found = find_lattices(seen, target, lens, settings)
    predictors = [without_deviating_shapes(lattice, seen, target, settings) for lattice in found]
    if target.rings is None:
        predictors = [_without_marks(predictor, target, settings) for predictor in predictors]
    outlines = lens.outlines(seen)
    if not predictors:
        return Refusal.NO_GRID
    outcomes = [number_lattice(predictor.lattice, outlines, target, settings) for predictor in predictors]
    named = [
        Grid(predictor, outcome)
        for predictor, outcome in zip(predictors, outcomes, strict=True)
        if not isinstance(outcome, Refusal)
    ]
    refusal = numbering_refusal(outcomes, target)
    if refusal is not None:
        return refusal
    lattice = named[0].lattice
    smooth = is_smooth(lattice, outlines.centre, settings) or is_smooth_through_fisheye(
        lattice, seen.centre, size, settings
    )
    return named[0] if smooth else Refusal.GRID_INCONSISTENT


def _without_marks(predictor: Predictor, target: DotGrid, settings: GridSettings) -> Predictor:
    """Return a lattice without marks beside it, in its predictor."""
    lattice = without_marks_beside(predictor.lattice, predictor.outlines, target, settings)
    return predictor if lattice is predictor.lattice else Predictor(lattice, predictor.outlines, settings)
