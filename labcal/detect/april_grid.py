"""From a picture of an AprilGrid to the corners of its tags: saddle points, codes, ids, and fits."""

from collections.abc import Iterator
from itertools import chain

import numpy as np

from labcal.arrays import DotIndices, Pixels
from labcal.detect.bare_tags import bare_corners, has_corner_squares, read_bare_tags
from labcal.detect.checks.refusals import hardly_measured
from labcal.detect.corners.corner_agreement import without_disagreeing
from labcal.detect.corners.corners import Corners, spans_a_plane
from labcal.detect.corners.enlarged import Enlarged, enlarged_picture
from labcal.detect.corners.markers_elsewhere import ids_read_again
from labcal.detect.corners.picture_corners import picture_corners, refused_as_few
from labcal.detect.corners.reduced import Reduced, reduced_pictures
from labcal.detect.corners.saddle_angles import unturned
from labcal.detect.corners.saddles import find_saddles
from labcal.detect.corners.tag_codes import SeenTags, read_tags
from labcal.detect.corners.tag_places import PlacedTags, cells_along, tags_in_place
from labcal.detect.corners.tag_search import OFFSETS, measured_tags
from labcal.detect.corners.tags_beyond import first_id_of_rows
from labcal.detect.corners.tags_elsewhere import ids_of_tags, why_no_tags
from labcal.detect.dots import PictureDots
from labcal.detect.flags import Refusal
from labcal.detect.grey import GreyPicture
from labcal.detect.lattice.lattice import Lattice
from labcal.detect.lattice.rough_undistortion import fisheyes_of
from labcal.detect.lattice.smoothness import is_smooth
from labcal.detect.settings import DetectSettings
from labcal.geometry.two_by_two import determinants
from labcal.targets.april_grid import AprilGrid
from labcal.wording import counted

_SMALL_CELL_PX = 3.0
"""Side of a cell below which an enlarged picture may show more of them."""
_LEAST_CELL_PX = 2.0
"""Side of a cell below which corners of tags run into each other."""
_SOFTEST = 0.95
"""Blur of the edges, of a cell's side, from which on corners are not where a fit finds them."""
_FEWEST = 4
"""Corners that determine a homography."""
_ON_A_LINE = 1e-6
"""Determinant of the scatter of nodes on a line, which are whole numbers: of others it is at least 1 / 4."""
_HAS_SQUARES = "Small black squares touch the corners of the tags, which the target says are not printed."
_ENOUGH = 0.5
"""Share of the board's tags in place after which no finer picture is searched."""


def detect_april_grid(grey: GreyPicture, grid: AprilGrid, settings: DetectSettings) -> PictureDots:
    """Find the corners of a grid's tags in one picture.

    Tags are read between saddle points. Those that agree place the grid; tags beside them that were not read
    are looked for corner by corner where they should be. Each corner is fitted as that of a chessboard, or,
    on a print without small squares, as that of a black wedge on white.

    Parameters
    ----------
    grey : ndarray, shape (h, w)
        The picture.
    grid : AprilGrid
        The target to look for.
    settings : DetectSettings

    Returns
    -------
    PictureDots
        Without outlines; a corner of a tag that is read and cannot be measured, or that is not where the
        others predict it, is flagged ``bad-fit``, or ``cut`` at the frame. Refused where no two tags are read
        in the grid's places, or the same ones at two places; where the print has small squares and the target
        has none or the other way round, or another border or set of tags; where fewer than four corners are
        measured, and where they lie on no smooth surface.
    """
    if grid.corner_squares:
        seen, placed = _placed(grey, grid, settings)
    else:
        seen = read_bare_tags(grey, grid, settings)
        placed = tags_in_place(seen, grid, settings.corner, fisheyes_of(grey, settings.grid))
    other = _another(grey, seen, placed, grid)
    if other is not None:
        return _refused(grey, other, settings)
    if len(placed) == 0:
        refusal, detail = why_no_tags(grey, seen, grid, settings)
        if grid.corner_squares and len(_placed(np.ascontiguousarray(grey[:, ::-1]), grid, settings)[1]):
            refusal = Refusal.MIRRORED
        return _refused(grey, (refusal, detail), settings)
    if grid.corner_squares:
        corners = measured_tags(grey, grid, placed, settings.corner)
    else:
        corners = bare_corners(grey, grid, placed.corners, settings.corner)
    dots = picture_corners(corners, grey, None, settings)
    cell = _cell_px(list(placed.corners.values()), grid)
    if cell < _LEAST_CELL_PX and hardly_measured(dots, settings.quality):
        return dots.refused(Refusal.TOO_SMALL, f"A cell of a tag is {cell:.1f} px wide.")
    dots = without_disagreeing(dots, grid.points(dots.index)[:, :2])
    index = dots.index[dots.ok]
    if not spans_a_plane(index):
        detail = f"{counted(len(placed), 'tag')} of {grid.tag_count} and {len(index)} of its {grid.count} "
        detail += "corners were found."
        return refused_as_few(dots, corners.index, detail)
    if not _is_smooth(index, dots.position[dots.ok], settings):
        return dots.refused(Refusal.GRID_INCONSISTENT)
    return _unless_too_soft(dots, corners, cell)


def _refused(grey: GreyPicture, why: tuple[Refusal, str], settings: DetectSettings) -> PictureDots:
    """Return a picture without corners, refused for a reason, with a sentence on what was seen."""
    return picture_corners(Corners.none(), grey, None, settings).refused(*why)


def _unless_too_soft(dots: PictureDots, corners: Corners, cell_px: float) -> PictureDots:
    """Return the corners of a picture, refused where cells run into each other: nothing is certain there."""
    blur = float(np.median([fit.state[4:6].max() for fit in corners.fits if fit is not None]))
    if blur < _SOFTEST * cell_px:
        return dots
    detail = f"A cell of a tag is {cell_px:.1f} px wide, and edges are blurred by {blur:.1f} px."
    return dots.refused(Refusal.BLURRED, detail)


def _another(
    grey: GreyPicture, seen: SeenTags, placed: PlacedTags, grid: AprilGrid
) -> tuple[Refusal, str] | None:
    """Return why tags in place are refused: the grid is there twice, has squares or another first id."""
    if len(placed) == 0:
        return None
    if placed.again:
        return Refusal.AMBIGUOUS_MARKERS, ids_read_again("Tag", placed.again)
    if not grid.corner_squares and has_corner_squares(grey, grid, placed.corners):
        return Refusal.CORNER_SQUARES, _HAS_SQUARES
    first = first_id_of_rows(seen, placed, grid)
    if first is None:
        return None
    return Refusal.OTHER_IDS, f"{ids_of_tags(seen, grid)} They fit the grid with first_id: {first}."


def _placed(grey: GreyPicture, grid: AprilGrid, settings: DetectSettings) -> tuple[SeenTags, PlacedTags]:
    """Return the tags that are read, and those in place, of the level that shows most; coarse ones first.

    Where few are in place, and their cells are small, the picture is enlarged.
    """
    seen, best = SeenTags(np.zeros(0, dtype=np.int64), np.zeros((0, 4, 2))), PlacedTags({})
    lenses = fisheyes_of(grey, settings.grid)
    levels: Iterator[Reduced | Enlarged] = chain(reduced_pictures(grey, settings), _enlarged(grey, settings))
    for level in levels:
        if (
            isinstance(level, Enlarged)
            and len(best)
            and _cell_px(list(best.corners.values()), grid) > _SMALL_CELL_PX
        ):
            break
        saddles = unturned(find_saddles(level.grey, settings.saddle), settings)
        tags = read_tags(level.grey, saddles, grid)
        tags = SeenTags(tags.number, level.in_full(tags.corners))
        placed = tags_in_place(tags, grid, settings.corner, lenses)
        seen = tags if len(tags.number) >= len(seen.number) else seen
        best = placed if len(placed) >= len(best) else best
        if len(best) >= _ENOUGH * grid.tag_count:
            break
    return seen, best


def _enlarged(grey: GreyPicture, settings: DetectSettings) -> Iterator[Enlarged]:
    """Return the picture enlarged, when it is asked for."""
    twice = enlarged_picture(grey, settings)
    if twice is not None:
        yield twice


def _cell_px(quads: list[Pixels], grid: AprilGrid) -> float:
    """Return the usual side of a cell of some tags, px."""
    sides = np.linalg.norm(np.array(quads) - np.roll(quads, 1, axis=1), axis=-1)
    return float(np.median(sides.min(axis=1))) / cells_along(grid)


def _is_smooth(index: DotIndices, seen: Pixels, settings: DetectSettings) -> bool:
    """Tell whether corners of one kind, which are evenly spaced, lie on a smooth surface, of each kind."""
    for kind in OFFSETS:
        own = (index % 2 == kind).all(axis=1)
        nodes = index[own] // 2
        if not _determines_a_map(nodes):
            continue
        lattice = Lattice({(int(i), int(j)): k for k, (i, j) in enumerate(nodes)})
        if not is_smooth(lattice, seen[own], settings.grid):
            return False
    return True


def _determines_a_map(nodes: np.ndarray) -> bool:
    """Tell whether nodes (n, 2) determine a homography: without any one of them the others span a plane."""
    if len(nodes) < _FEWEST:
        return False
    away = nodes - nodes.mean(axis=0)
    without = away.T @ away - away[:, :, None] * away[:, None, :] * (len(nodes) / (len(nodes) - 1.0))
    return bool(determinants(without).min() > _ON_A_LINE)
