"""From a picture to its dots: the stages of detection in order."""

from collections.abc import Sequence
from dataclasses import replace

import numpy as np

from labcal.arrays import Pixels
from labcal.detect.checks.missing_dots import UnmeasuredDot, unmeasured_dots
from labcal.detect.checks.no_grid import why_no_grid
from labcal.detect.checks.refusals import cause, hardly_measured, in_this_light
from labcal.detect.dots import PictureDots
from labcal.detect.edge_fit import fit_edges
from labcal.detect.flagged_dots import FlaggedDots
from labcal.detect.flags import DotFlag, Refusal
from labcal.detect.foreign_dots import require_detections
from labcal.detect.grey import AnyPicture, GreyPicture, grey_picture
from labcal.detect.grid import Grid, find_grid
from labcal.detect.lattice.bare_paper import dots_of_lines
from labcal.detect.lattice.beside import distance_to_nearest
from labcal.detect.lattice.marks_beside import dots_among
from labcal.detect.lattice.missed import with_missed
from labcal.detect.lattice.numbering import AnyNumbering
from labcal.detect.lattice.plain import continues_beyond_grid, with_symmetric_numberings
from labcal.detect.lattice.plain_part import plain_part
from labcal.detect.lattice.prediction import Predictor
from labcal.detect.light_fall import in_falling_light
from labcal.detect.medians import median_of
from labcal.detect.outlines.outlines import Outlines, clear_reach
from labcal.detect.quality import are_rings, flag_dots
from labcal.detect.segmentation import Candidates, segmentations
from labcal.detect.settings import DEFAULTS, DetectSettings
from labcal.detect.stage_settings.quality import QualitySettings
from labcal.targets.catalogue import AnyTarget
from labcal.targets.grid import DotGrid, Polarity
from labcal.targets.registry import is_shipped, kind_of, run_part


def detect_dots(image: AnyPicture, target: AnyTarget, settings: DetectSettings | None = None) -> PictureDots:
    """Find the target's dots, or the corners of a ChArUco board, in one picture.

    The target's polarity is tried first. Where that gives no ids the other one is tried, and taken only if it
    does.

    Parameters
    ----------
    image : ndarray, shape (h, w), (h, w, 3) or (h, w, 4)
        uint8, uint16 or float; colour in any order.
    target : AnyTarget
        The target to look for.
    settings : DetectSettings, optional
        Thresholds, sizes and counts of all stages; the defaults where not given.

    Returns
    -------
    PictureDots
        With a `refusal` where the picture has no ids: a picture is never given doubtful ones.

    Raises
    ------
    InputTypeError, InputError
        `image` is no picture (see :func:`labcal.detect.grey.grey_picture`); or the target is of a kind of the
        user's whose detector fails, or returns what is no detection.
    """
    settings = DEFAULTS if settings is None else settings
    found = in_this_light(_detect_dots(image, target, settings), image, settings)
    refused = found.indexed and hardly_measured(found, settings.quality)
    return found.unusable() if refused else found


def _detect_dots(image: AnyPicture, target: AnyTarget, settings: DetectSettings) -> PictureDots:
    """Find dots or corners with the detector of the target's kind."""
    grey = grey_picture(image)
    if np.shares_memory(grey, image):
        grey = grey.copy()  # a detector may work in place, since it may be large
    kind, size = kind_of(target), (grey.shape[1], grey.shape[0])
    found: PictureDots = run_part(kind, "detector", grey, target, settings)
    if not is_shipped(kind):
        require_detections(f"The kind of target '{kind.name}': its 'detector'", found, target, size)
    return found


def detect_grid_dots(grey: GreyPicture, target: DotGrid, settings: DetectSettings) -> PictureDots:
    """Find the dots of a grid in a picture, which is turned into its negative in place where that helps."""
    black = 0.0
    if target.polarity is Polarity.WHITE_ON_BLACK:
        black = _invert(grey, black)
    first = _detect((grey, black), target, target.polarity, settings)
    if first.indexed:
        return first
    black = _invert(grey, black)
    other = Polarity.WHITE_ON_BLACK if target.polarity is Polarity.BLACK_ON_WHITE else Polarity.BLACK_ON_WHITE
    second = _detect((grey, black), target, other, settings)
    return second if second.indexed else first


def _invert(grey: GreyPicture, black: float) -> float:
    """Turn a picture into its negative, in place; return its grey value of no light, which was `black`."""
    if grey.size == 0:
        return black
    largest = grey.max()
    np.subtract(largest, grey, out=grey)
    return float(largest) - black


def _detect(
    picture: tuple[GreyPicture, float], target: DotGrid, polarity: Polarity, settings: DetectSettings
) -> PictureDots:
    """Detect dots of one polarity, which are dark in a picture with its grey value of no light."""
    grey, black = picture
    size = (grey.shape[1], grey.shape[0])
    candidates, grid = _search(grey, target, settings)
    if isinstance(grid, Refusal):
        refusal = cause(grid, grey, candidates.whole, settings)
        refusal, detail = why_no_grid(refusal, grey, candidates, target, settings)
        every = _unnamed(candidates.whole.joined(candidates.cut))
        seen = refusal is Refusal.AMBIGUOUS
        part = _part(picture, polarity, candidates.whole, target, settings) if seen else None
        return replace(every.collected(size, polarity, refusal), detail=detail, part=part)
    numbering = grid.numbering
    lattice, outlines = with_missed(grey, grid.lattice, numbering, candidates.whole, target, settings)
    same = lattice is grid.lattice
    predictor = grid.predictor if same else Predictor(lattice, outlines, settings.grid)
    unmeasured = unmeasured_dots(
        predictor,
        candidates.blobs,
        size,
        lambda node: target.holds(*numbering.index(node)),
        settings.quality,
    )
    if target.rings is None:
        further = dots_among(unmeasured, predictor, candidates.whole, settings.grid)
        if continues_beyond_grid(further, numbering, target, settings.grid):
            further = dots_of_lines(grey, further, predictor, numbering, target)
        if continues_beyond_grid(further, numbering, target, settings.grid):
            every = _unnamed(candidates.whole.joined(candidates.cut))
            detail = "The target's columns and rows were seen, and dots beyond them."
            return replace(every.collected(size, polarity, Refusal.AMBIGUOUS), detail=detail)
    spots = lattice.numbers
    holes = np.where(are_rings(numbering.indices(lattice.nodes), target), target.hole_share, 0.0)
    reach = clear_reach(target, settings.segmentation)
    fits = fit_edges(grey, outlines.select(spots), holes, reach, black, settings.edge)
    dots = flag_dots(in_falling_light(fits), predictor, numbering, target, settings)
    dots = dots.joined([_with_places(unmeasured, numbering)])
    others = np.ones(len(outlines.centre), dtype=bool)
    others[spots] = False
    unnamed = outlines.select(others).joined(candidates.cut)
    if len(unnamed.centre) > 0:
        typical = median_of(outlines.radius[spots])
        dots = dots.joined([_further(unnamed, typical, dots.seen_at, settings.quality)])
    return with_symmetric_numberings(dots.collected(size, polarity, None), target)


def _with_places(dots: Sequence[UnmeasuredDot], numbering: AnyNumbering) -> FlaggedDots:
    """Return dots that are not measured, at their places in the grid."""
    nodes = np.array([dot.node for dot in dots], dtype=np.int64).reshape(-1, 2)
    seen_at = np.array([dot.seen_at for dot in dots]).reshape(-1, 2)
    outline = np.array([dot.outline for dot in dots]).reshape(-1, 2, 2)
    return FlaggedDots.not_measured(
        numbering.indices(nodes), tuple(dot.flag for dot in dots), seen_at, outline
    )


def _part(
    picture: tuple[GreyPicture, float],
    polarity: Polarity,
    outlines: Outlines,
    target: DotGrid,
    settings: DetectSettings,
) -> PictureDots | None:
    """Return the measured dots of a part of a plain grid, under all numberings that fit; None without any."""
    lattice, numberings = plain_part(outlines, target, settings.grid)
    if not numberings:
        return None
    grey, black = picture
    spots, reach = lattice.numbers, clear_reach(target, settings.segmentation)
    fits = fit_edges(grey, outlines.select(spots), np.zeros(len(spots)), reach, black, settings.edge)
    predictor = Predictor(lattice, outlines, settings.grid)
    dots = flag_dots(in_falling_light(fits), predictor, numberings[0], target, settings)
    found = dots.collected((grey.shape[1], grey.shape[0]), polarity, None)
    node_of = {numberings[0].index(node): node for node in lattice.spots}
    nodes = [node_of[int(col), int(row)] for col, row in found.index]
    others = [np.array([one.index(node) for node in nodes], dtype=np.int64) for one in numberings[1:]]
    return replace(found, others=tuple(others))


def _search(
    grey: GreyPicture, target: DotGrid, settings: DetectSettings
) -> tuple[Candidates, Grid | Refusal]:
    """Return the candidates of a picture, and their grid, from a coarse level on until nothing is missed."""
    for candidates in segmentations(grey, target, settings.segmentation):
        grid = find_grid(candidates.whole, target, (grey.shape[1], grey.shape[0]), settings.grid)
        if not isinstance(grid, Refusal) and candidates.resolve(candidates.whole.shape[grid.spots]):
            break
    return candidates, grid


def _unnamed(outlines: Outlines) -> FlaggedDots:
    """Return spots without a place in the grid."""
    flag = (DotFlag.NO_ID,) * len(outlines.centre)
    return FlaggedDots.not_measured(None, flag, outlines.centre, outlines.shape)


def _further(outlines: Outlines, radius: float, taken: Pixels, settings: QualitySettings) -> FlaggedDots:
    """Return the spots that a person might take for dots, and that are none of those at places (n, 2)."""
    size = outlines.radius
    alike = np.abs(np.log(size / radius)) < settings.no_id_radius_log
    apart = distance_to_nearest(outlines.centre, taken) > settings.no_id_distance_radii * size
    return _unnamed(outlines.select(alike & apart))
