"""From a picture of a ChArUco board to its corners: markers by OpenCV, places by a fit of our own."""

import numpy as np

from labcal.detect.corners.board_by_codes import corners_by_codes
from labcal.detect.corners.corner_agreement import without_disagreeing
from labcal.detect.corners.corners import Corners, measured_corners, spans_a_plane
from labcal.detect.corners.marker_places import PlacedMarkers, corners_beside, markers_in_place
from labcal.detect.corners.markers_elsewhere import ids_read_again, why_not_in_place
from labcal.detect.corners.picture_corners import picture_corners, refused_as_torn, square_px
from labcal.detect.corners.printed_fits import printed_corners
from labcal.detect.corners.seen_markers import SeenMarkers, seen_markers
from labcal.detect.dots import PictureDots
from labcal.detect.flags import Refusal
from labcal.detect.grey import GreyPicture
from labcal.detect.lattice.lattice import Lattice
from labcal.detect.lattice.rough_undistortion import fisheyes_of
from labcal.detect.lattice.smoothness import is_smooth
from labcal.detect.settings import DetectSettings
from labcal.detect.stage_settings.corner import CornerSettings
from labcal.targets.charuco import CharucoBoard
from labcal.wording import counted

_FEW = 3
"""Markers in place, up to which the lattice of corners is looked for: what few predict may be far off."""


def detect_charuco(grey: GreyPicture, board: CharucoBoard, settings: DetectSettings) -> PictureDots:
    """Find the board's corners in one picture.

    OpenCV reads the markers. Those that agree place the board, and with it the corners beside them; further
    corners are found by their place among those. Where a corner is, the two edges that cross there determine
    (:mod:`labcal.detect.corners.corners`).

    Parameters
    ----------
    grey : ndarray, shape (h, w)
        The picture.
    board : CharucoBoard
        The board to look for.
    settings : DetectSettings

    Returns
    -------
    PictureDots
        Without outlines; a corner that is known by its markers and cannot be measured, or that is not where
        the others predict it, is flagged ``bad-fit``, or ``cut`` at the frame. Refused where no two markers
        are read in the board's places, or the same ones at two places; where fewer than four corners, or
        corners of one line only, are measured; and where they lie on no smooth surface.
    """
    seen = _read(grey, board, settings.corner)
    placed = _placed(seen, grey, board, settings)
    if placed.again:
        why = Refusal.AMBIGUOUS_MARKERS, ids_read_again("Marker", placed.again)
        return picture_corners(Corners.none(), grey, None, settings).refused(*why)
    further: set[tuple[int, int]] = set()
    if len(placed.number):
        rough = corners_beside(placed, board)
        found = Corners(rough.index, rough.q, [None] * len(rough.index), rough.axes)
        further = {(int(i), int(j)) for i, j in rough.index[~rough.beside]}
        if len(placed.number) <= _FEW:
            by_codes = corners_by_codes(grey, board, settings)
            if len(by_codes.index) > len(found.index):
                found, further = by_codes, set()
    else:
        refusal, detail = why_not_in_place(seen, board, settings.corner)
        unread = refusal in (Refusal.NO_MARKERS, Refusal.MARKERS_UNREADABLE)
        found = corners_by_codes(grey, board, settings) if unread else Corners.none()
        if len(found.index) == 0 and _in_a_mirror(grey, board, settings):
            refusal = Refusal.MIRRORED
        if len(found.index) == 0:
            return picture_corners(Corners.none(), grey, None, settings).refused(refusal, detail)
    corners = measured_corners(grey, board, found, settings)
    corners = printed_corners(grey, board, corners, settings.corner)
    kept = [
        fit is not None or (int(i), int(j)) not in further
        for fit, (i, j) in zip(corners.fits, corners.index, strict=True)
    ]
    corners = corners.select(np.flatnonzero(kept))
    dots = picture_corners(corners, grey, None, settings)
    dots = without_disagreeing(dots, dots.index.astype(np.float64))
    ok = np.flatnonzero(dots.ok)
    if not found.spans_a_plane() or not spans_a_plane(dots.index[ok]):
        by = counted(len(placed.number), "marker") if len(placed.number) else "the likeness of its codes"
        detail = f"{len(found.index)} of the board's {board.count} corners were placed by {by}, {len(ok)} "
        detail += "measured."
        if len(placed.number) == 0 and _has_large_squares(found, board, settings.corner):
            return dots.refused(Refusal.BLURRED, f"{detail} No marker is sharp enough to be read.")
        return refused_as_torn(dots, found.index, detail, settings.corner)
    lattice = Lattice({(int(dots.index[k, 0]), int(dots.index[k, 1])): int(k) for k in ok})
    smooth = is_smooth(lattice, dots.position, settings.grid)
    return dots if smooth else dots.refused(Refusal.GRID_INCONSISTENT)


def _has_large_squares(found: Corners, board: CharucoBoard, settings: CornerSettings) -> bool:
    """Tell whether markers are so large in the picture that blur alone can hide their codes."""
    marker = square_px(found.index, found.seen_at) * board.marker_mm / board.square_mm
    return marker > 2.0 * settings.min_marker_px


def _in_a_mirror(grey: GreyPicture, board: CharucoBoard, settings: DetectSettings) -> bool:
    """Tell whether markers place the board in a mirrored picture."""
    mirrored = np.ascontiguousarray(grey[:, ::-1])
    seen = _read(mirrored, board, settings.corner)
    return len(_placed(seen, grey, board, settings).number) > 0


def _placed(
    seen: SeenMarkers, grey: GreyPicture, board: CharucoBoard, settings: DetectSettings
) -> PlacedMarkers:
    """Return the markers in place, also through wide lenses."""
    return markers_in_place(seen, board, settings.corner, fisheyes_of(grey, settings.grid))


def _read(grey: GreyPicture, board: CharucoBoard, settings: CornerSettings) -> SeenMarkers:
    """Read the markers of the board's dictionary, in a picture as bytes; none in a small or even one."""
    cut = settings.range_cut_percent
    large_enough = min(grey.shape) >= settings.min_picture_px
    low, high = np.percentile(grey, [cut, 100.0 - cut]) if large_enough else (0.0, 0.0)
    if high <= low:
        return SeenMarkers.none()
    bytes_ = np.clip((grey - low) * (255.0 / (high - low)), 0, 255).astype(np.uint8)
    return seen_markers(bytes_, board, settings)
