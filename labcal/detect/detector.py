"""From a picture to its dots: the stages of detection in order."""

from collections import Counter
from dataclasses import replace

import numpy as np

from labcal.detect.checks.missing_dots import unmeasured_dots
from labcal.detect.checks.no_grid import why_no_grid
from labcal.detect.checks.refusals import cause, hardly_measured, in_this_light
from labcal.detect.dots import PictureDots
from labcal.detect.edge_fit import fit_edges
from labcal.detect.flags import DotFlag, Refusal
from labcal.detect.foreign_dots import require_detections
from labcal.detect.grey import AnyPicture, GreyPicture, grey_picture
from labcal.detect.grid import Grid, find_grid
from labcal.detect.lattice.bare_paper import dots_of_lines
from labcal.detect.lattice.marks_beside import dots_among
from labcal.detect.lattice.missed import with_missed
from labcal.detect.lattice.plain import continues_beyond_grid, with_symmetric_numberings
from labcal.detect.lattice.plain_part import plain_part
from labcal.detect.lattice.prediction import Predictor
from labcal.detect.light_fall import in_falling_light
from labcal.detect.medians import median_of
from labcal.detect.outlines.outlines import Outlines, clear_reach
from labcal.detect.quality import FlaggedDot, flag_dots
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
        every = _unnamed(candidates.whole.joined(candidates.cut), set())
        seen = refusal is Refusal.AMBIGUOUS
        part = _part(picture, polarity, candidates.whole, target, settings) if seen else None
        return replace(_collect(every, size, polarity, refusal), detail=detail, part=part)
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
            every = _unnamed(candidates.whole.joined(candidates.cut), set())
            detail = "The target's columns and rows were seen, and dots beyond them."
            return replace(_collect(every, size, polarity, Refusal.AMBIGUOUS), detail=detail)
    spots = list(lattice.spots.values())
    rings = target.ring_indices
    ring = np.array([numbering.index(node) in rings for node in lattice.spots])
    holes = np.where(ring, target.hole_share, 0.0)
    reach = clear_reach(target, settings.segmentation)
    fits = fit_edges(grey, outlines.select(np.array(spots)), holes, reach, black, settings.edge)
    dots = flag_dots(in_falling_light(fits), predictor, numbering, target, settings)
    dots += [FlaggedDot(numbering.index(dot.node), dot.flag, dot.seen_at, dot.outline) for dot in unmeasured]
    unnamed = _unnamed(outlines.joined(candidates.cut), set(spots))
    if unnamed:
        typical = median_of(outlines.radius[spots])
        dots += _further(unnamed, typical, np.array([dot.seen_at for dot in dots]), settings.quality)
    return with_symmetric_numberings(_collect(_unique_ids(dots), size, polarity, None), target)


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
    spots, reach = np.array(list(lattice.spots.values())), clear_reach(target, settings.segmentation)
    fits = fit_edges(grey, outlines.select(spots), np.zeros(len(spots)), reach, black, settings.edge)
    predictor = Predictor(lattice, outlines, settings.grid)
    dots = flag_dots(in_falling_light(fits), predictor, numberings[0], target, settings)
    found = _collect(dots, (grey.shape[1], grey.shape[0]), polarity, None)
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


def _unnamed(outlines: Outlines, named: set[int]) -> list[FlaggedDot]:
    """Return the spots that have no place in the grid."""
    return [
        FlaggedDot(None, DotFlag.NO_ID, outlines.centre[spot], outlines.shape[spot])
        for spot in range(len(outlines.centre))
        if spot not in named
    ]


def _further(
    unnamed: list[FlaggedDot], radius: float, taken: np.ndarray, settings: QualitySettings
) -> list[FlaggedDot]:
    """Return the spots that a person might take for dots, and that are none of those at places (n, 2)."""
    further = []
    for dot in unnamed:
        size = np.linalg.det(dot.outline) ** 0.25
        if not abs(np.log(size / radius)) < settings.no_id_radius_log:
            continue
        if np.linalg.norm(taken - dot.seen_at, axis=1).min() > settings.no_id_distance_radii * size:
            further.append(dot)
    return further


def _unique_ids(dots: list[FlaggedDot]) -> list[FlaggedDot]:
    """Return the dots with every id at most once; of two, neither can be trusted."""
    count = Counter(dot.place for dot in dots if dot.place is not None)
    return [
        dot if dot.place is None or count[dot.place] == 1 else dot._replace(place=None, flag=DotFlag.NO_ID)
        for dot in dots
    ]


def _collect(
    dots: list[FlaggedDot], size: tuple[int, int], polarity: Polarity, refusal: Refusal | None
) -> PictureDots:
    """Sort the dots and put them into arrays."""
    dots = sorted(
        dots,
        key=lambda dot: (
            dot.place is None,
            *(dot.place or (0, 0))[::-1],
            float(dot.seen_at[1]),
            float(dot.seen_at[0]),
        ),
    )
    missing = np.full((2, 2), np.nan)
    return PictureDots(
        size=size,
        polarity=polarity,
        refusal=refusal,
        index=np.array([dot.place or (0, 0) for dot in dots], dtype=np.int64).reshape(-1, 2),
        has_id=np.array([dot.place is not None for dot in dots], dtype=bool),
        position=_rows([missing[0] if dot.centre is None else dot.centre for dot in dots]),
        covariance=_rows(
            [missing if dot.covariance is None else dot.covariance for dot in dots],
        ).reshape(-1, 2, 2),
        misfit=np.array([dot.misfit for dot in dots], dtype=np.float64),
        flag=tuple([dot.flag for dot in dots]),
        seen_at=_rows([dot.seen_at for dot in dots]),
        outline=_rows([dot.outline for dot in dots]).reshape(-1, 2, 2),
    )


def _rows(parts: list[np.ndarray]) -> np.ndarray:
    """Return arrays, shape (2,) or (2, 2), as the rows of one, shape (n, 2); faster than `numpy.array`."""
    return np.concatenate(parts, axis=None).reshape(-1, 2) if parts else np.zeros((0, 2))
