"""From a picture of a plain chessboard to its corners: saddle points, lattice, ids, and fits."""

from dataclasses import dataclass, replace
from itertools import chain

import numpy as np

from labcal.detect.corners.board_lattice import find_board_lattices
from labcal.detect.corners.board_numbering import SeenBoard, number_board, part_numberings
from labcal.detect.corners.clipped_edges import burnt_words
from labcal.detect.corners.corner_agreement import without_disagreeing
from labcal.detect.corners.corners import Corners, measured_corners, spans_a_plane, widened_corners
from labcal.detect.corners.outer_lines import shown_lines, shows_outer_lines
from labcal.detect.corners.picture_corners import picture_corners, refused_as_torn, square_px
from labcal.detect.corners.reduced import Reduced, coarser_pictures, reduced_pictures
from labcal.detect.corners.saddles import Saddles, find_saddles
from labcal.detect.dots import PictureDots
from labcal.detect.flags import Refusal
from labcal.detect.grey import GreyPicture
from labcal.detect.lattice.lattice import Lattice
from labcal.detect.lattice.lines_seen import lines_words
from labcal.detect.lattice.rings import Numbering
from labcal.detect.lattice.rough_undistortion import NONE
from labcal.detect.lattice.smoothness import is_smooth
from labcal.detect.settings import DetectSettings
from labcal.detect.stage_settings.saddle import SaddleSettings
from labcal.targets.chessboard import Chessboard

_RIM_UNCLEAR = "An outermost line of the board was seen, but its corners are not clear enough to number it."

_SOFTEST_SQUARES = 0.15
"""Blur of edges, of a square's side, from which on it is what keeps corners from being measured."""


@dataclass(frozen=True)
class _Found:
    """A board in a picture: rough corners with their ids, or a refusal; and how many were seen.

    Corners of a part of a board have ids under the first of its numberings.
    """

    corners: Corners
    refusal: Refusal | None
    seen: int
    numberings: tuple[Numbering, ...] = ()
    detail: str = ""


def detect_chessboard(grey: GreyPicture, board: Chessboard, settings: DetectSettings) -> PictureDots:
    """Find the board's corners in one picture.

    Parameters
    ----------
    grey : ndarray, shape (h, w)
        The picture.
    board : Chessboard
        The board to look for.
    settings : DetectSettings

    Returns
    -------
    PictureDots
        Without outlines; a corner that is seen and cannot be measured, or that is not where the others
        predict it, is flagged ``bad-fit``, or ``cut`` at the frame. Refused where there is no lattice of
        corners of alternating colours, where it cannot be numbered
        (:func:`labcal.detect.corners.board_numbering.number_board`), and where it lies on no smooth surface.
        A board that looks the same after a turn has the other numberings in `others`.
    """
    found = _found(grey, board, settings)
    if found.refusal is not None:
        part, soft = _part(grey, board, found, settings)
        refusal, detail = (found.refusal, found.detail) if soft is None else (Refusal.BLURRED, soft)
        return replace(picture_corners(Corners.none(), grey, refusal, settings), part=part, detail=detail)
    corners = measured_corners(grey, board, found.corners, settings)
    corners = widened_corners(grey, board, corners, settings.corner)
    ok = np.flatnonzero([fit is not None for fit in corners.fits])
    if not corners.select(ok).spans_a_plane():
        return _torn(grey, picture_corners(corners, grey, None, settings), corners, board, settings)
    if not board.marks and not _shows_its_rim(corners.index[ok], board, settings.saddle):
        if _has_hard_edges(corners, settings) and _shows_its_rim(found.corners.index, board, settings.saddle):
            return _torn(grey, picture_corners(corners, grey, None, settings), corners, board, settings)
        return _rim_unclear(grey, picture_corners(corners, grey, None, settings), corners, settings)
    lattice = Lattice({(int(corners.index[k, 0]), int(corners.index[k, 1])): int(k) for k in ok})
    if not is_smooth(lattice, corners.seen_at, settings.grid):
        return picture_corners(corners, grey, Refusal.GRID_INCONSISTENT, settings)
    return _agreeing(grey, board, corners, settings)


def _agreeing(
    grey: GreyPicture, board: Chessboard, corners: Corners, settings: DetectSettings
) -> PictureDots:
    """Return the corners that agree with each other, refused where they no longer number the board."""
    dots = picture_corners(corners, grey, None, settings)
    dots = without_disagreeing(dots, dots.index.astype(np.float64))
    index = dots.index[dots.ok]
    if not spans_a_plane(index):
        return _torn(grey, dots, corners, board, settings)
    if not board.marks and not _shows_its_rim(index, board, settings.saddle):
        return _rim_unclear(grey, dots, corners, settings)
    return replace(dots, others=board.symmetric_indices(dots.index))


def _rim_unclear(
    grey: GreyPicture, dots: PictureDots, corners: Corners, settings: DetectSettings
) -> PictureDots:
    """Return the corners of a board refused since too few of an outermost line are measured."""
    soft = _too_soft(corners)
    if soft is not None:
        return dots.refused(Refusal.BLURRED, soft)
    return dots.refused(Refusal.BOARD_IN_PART, _RIM_UNCLEAR + burnt_words(grey, corners.seen_at, settings))


def _too_soft(corners: Corners) -> str | None:
    """Return a sentence on blur and squares where edges run into each other; None where they do not."""
    blurs = [fit.state[4:6].mean() for fit in corners.fits if fit is not None]
    side = square_px(corners.index, corners.seen_at)
    blur = float(np.median(blurs)) if blurs else 0.0
    if blur < _SOFTEST_SQUARES * side:
        return None
    return f"Squares are {side:.0f} px wide, and edges are blurred by {blur:.1f} px."


def _torn(
    grey: GreyPicture, dots: PictureDots, corners: Corners, board: Chessboard, settings: DetectSettings
) -> PictureDots:
    """Return the corners of a board that is seen and numbered, refused because too few are measured."""
    soft = _too_soft(corners)
    if soft is not None:
        return dots.refused(Refusal.BLURRED, soft)
    detail = f"{len(corners.index)} of the board's {board.count} corners were seen, {dots.ok.sum()} measured."
    if _has_hard_edges(corners, settings):
        detail += " The edges have no blur, as in a drawing or a picture made black and white."
    else:
        detail += burnt_words(grey, corners.seen_at, settings)
    return refused_as_torn(dots, corners.index, detail, settings.corner)


def _has_hard_edges(corners: Corners, settings: DetectSettings) -> bool:
    """Tell whether most of the measured corners have edges without blur, between which no fit settles."""
    blurs = [fit.state[4:6].min() for fit in corners.fits if fit is not None]
    return bool(blurs) and float(np.median(blurs)) <= settings.corner.min_blur_px


def _shows_its_rim(index: np.ndarray, board: Chessboard, settings: SaddleSettings) -> bool:
    """Tell whether each outermost line is measured in part: what numbers a board without marks."""
    filled = np.ptp(index, axis=0) == [board.cols - 1, board.rows - 1]
    return bool(filled.all()) and shows_outer_lines(index, settings)


def _found(grey: GreyPicture, board: Chessboard, settings: DetectSettings) -> _Found:
    """Return the board from the first level of the picture at which it can be numbered.

    Coarse ones come first, since they are searched faster; one that is coarser still comes last, since it
    shows large squares only.
    """
    best = _Found(Corners.none(), Refusal.NO_CHESSBOARD, 0)
    for level in chain(reduced_pictures(grey, settings), coarser_pictures(grey, settings)):
        found = _found_at(level, board, settings)
        if found.refusal in (None, Refusal.SEVERAL_TARGETS):
            return found
        best = found if found.seen > best.seen else best
    return best


def _found_at(level: Reduced, board: Chessboard, settings: DetectSettings) -> _Found:
    """Return the board as it is seen in a picture that is reduced by a whole number."""
    saddles = find_saddles(level.grey, settings.saddle)
    lattices = find_board_lattices(saddles, max(board.cols, board.rows), NONE, settings)
    outcomes = [number_board(SeenBoard(one, saddles, level.grey), board, settings) for one in lattices]
    numbered = [
        (lattice, outcome)
        for lattice, outcome in zip(lattices, outcomes, strict=True)
        if not isinstance(outcome, Refusal)
    ]
    seen = len(lattices[0]) if lattices else 0
    if len(numbered) > 1:
        return _Found(Corners.none(), Refusal.SEVERAL_TARGETS, seen)
    if not numbered:
        first = next((one for one in outcomes if isinstance(one, Refusal)), Refusal.NO_CHESSBOARD)
        detail = _lines_seen(lattices[0], saddles, level, board, settings.saddle) if lattices else ""
        if first is Refusal.BOARD_IN_PART and not board.marks:
            return replace(_found_part(lattices[0], saddles, level, board, settings), detail=detail)
        return _Found(Corners.none(), first, seen, detail=detail)
    lattice, numbering = numbered[0]
    if not is_smooth(lattice, saddles.place, settings.grid):
        return _Found(Corners.none(), Refusal.GRID_INCONSISTENT, seen)
    corners = _rough_corners(lattice, numbering, saddles, level)
    own = ((corners.index >= 0) & (corners.index < [board.cols, board.rows])).all(axis=1)
    return _Found(corners.select(np.flatnonzero(own)), None, seen)


def _lines_seen(
    lattice: Lattice, saddles: Saddles, level: Reduced, board: Chessboard, settings: SaddleSettings
) -> str:
    """Return how many columns and rows of corners are seen, and where, as a sentence."""
    nodes = np.array(list(lattice.spots), dtype=np.int64)
    shown = shown_lines(nodes, settings)
    nodes, q = nodes[shown], level.in_full(saddles.place[list(lattice.spots.values())])[shown]
    return lines_words(nodes, q, "corners", (board.cols, board.rows))


def _found_part(
    lattice: Lattice, saddles: Saddles, level: Reduced, board: Chessboard, settings: DetectSettings
) -> _Found:
    """Return a part of a board, under all numberings that fit, as far as it lies on a smooth surface."""
    smooth = is_smooth(lattice, saddles.place, settings.grid)
    numberings = part_numberings(SeenBoard(lattice, saddles, level.grey), board) if smooth else []
    if not numberings:
        return _Found(Corners.none(), Refusal.BOARD_IN_PART, len(lattice))
    corners = _rough_corners(lattice, numberings[0], saddles, level)
    return _Found(corners, Refusal.BOARD_IN_PART, len(lattice), tuple(numberings))


def _rough_corners(lattice: Lattice, numbering: Numbering, saddles: Saddles, level: Reduced) -> Corners:
    """Return the corners of a lattice with their ids, at places of the whole picture."""
    index = np.array([numbering.index(node) for node in lattice.spots], dtype=np.int64)
    place = level.in_full(saddles.place[list(lattice.spots.values())])
    return Corners(index, place, [None] * len(index))


def _part(
    grey: GreyPicture, board: Chessboard, found: _Found, settings: DetectSettings
) -> tuple[PictureDots | None, str | None]:
    """Return the measured corners of a part of a board, under all numberings that fit; None without any.

    And a sentence if it is blurred, as of :func:`_too_soft`: more of the board may be in sight then.
    """
    if not found.numberings:
        return None, None
    first, *others = found.numberings
    known = set(map(tuple, found.corners.index.tolist()))
    corners = measured_corners(grey, board, found.corners, settings)
    # Further corners were looked for as if the first numbering were right.
    corners = corners.select(
        np.array(
            [k for k, place in enumerate(corners.index.tolist()) if tuple(place) in known], dtype=np.int64
        )
    )
    soft = _too_soft(corners)
    if soft is not None:
        return None, soft
    dots = picture_corners(corners, grey, None, settings)
    dots = without_disagreeing(dots, dots.index.astype(np.float64))
    nodes = (dots.index - first.shift) @ first.turn
    return replace(dots, others=tuple(nodes @ one.turn.T + one.shift for one in others)), None
