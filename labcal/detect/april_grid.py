"""From a picture of an AprilGrid to the corners of its tags: saddle points, codes, ids, and fits."""

from collections import deque

import numpy as np

from labcal.arrays import Pixels
from labcal.detect.corners.corner_fit import SettledCorner
from labcal.detect.corners.corners import Corners, Standard
from labcal.detect.corners.markers_elsewhere import ids_read
from labcal.detect.corners.picture_corners import picture_corners, refused_as_few
from labcal.detect.corners.reduced import reduced_pictures
from labcal.detect.corners.saddles import find_saddles
from labcal.detect.corners.tag_places import expected_tags, tags_in_place
from labcal.detect.corners.tag_quads import SeenTags, read_tags
from labcal.detect.corners.tag_saddle import TagSaddle, fit_tag_saddle
from labcal.detect.dots import PictureDots
from labcal.detect.flags import Refusal
from labcal.detect.grey import GreyPicture
from labcal.detect.lattice.lattice import Lattice
from labcal.detect.lattice.smoothness import is_smooth
from labcal.detect.settings import DetectSettings
from labcal.targets.april_grid import AprilGrid
from labcal.targets.charuco_opencv import opencv_dictionary
from labcal.wording import counted

_ENOUGH = 0.5
"""Share of the board's tags in place after which no finer picture is searched."""
_ROUGH_CORNERS = 3
"""Corners to either side whose residuals are the usual ones."""
_OFFSETS = ((0, 0), (1, 0), (1, 1), (0, 1))
"""Column and row of a tag's corners against its lower left one, anticlockwise."""


def detect_april_grid(grey: GreyPicture, grid: AprilGrid, settings: DetectSettings) -> PictureDots:
    """Find the corners of a grid's tags in one picture.

    Tags are read between saddle points. Those that agree place the grid; tags beside them that were not read
    are looked for corner by corner where they should be. Each corner is fitted as that of a chessboard.

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
        Without outlines; a corner of a tag that is read and cannot be measured is flagged ``bad-fit``, or
        ``cut`` at the frame. Refused where no two tags are read in the grid's places, where fewer than four
        corners are measured, and where they lie on no smooth surface.
    """
    seen, placed = _placed(grey, grid, settings)
    if not placed:
        refusal, detail = _why_not(seen, grid)
        return picture_corners(Corners.none(), grey, None, settings).refused(refusal, detail)
    corners = _measured(grey, grid, placed, settings)
    dots = picture_corners(corners, grey, None, settings)
    ok = np.flatnonzero([fit is not None for fit in corners.fits])
    if not corners.select(ok).spans_a_plane():
        detail = f"{counted(len(placed), 'tag')} of {grid.tag_count} and {len(ok)} of its {grid.count} "
        detail += "corners were found."
        return refused_as_few(dots, corners.index, detail)
    return dots if _is_smooth(corners, ok, settings) else dots.refused(Refusal.GRID_INCONSISTENT)


def _placed(
    grey: GreyPicture, grid: AprilGrid, settings: DetectSettings
) -> tuple[SeenTags, dict[int, Pixels]]:
    """Return the tags that are read, and those in place, of the level that shows most; coarse ones first."""
    seen, best = SeenTags(np.zeros(0, dtype=np.int64), np.zeros((0, 4, 2))), dict[int, Pixels]()
    for level in reduced_pictures(grey, settings):
        tags = read_tags(level.grey, find_saddles(level.grey, settings.saddle), grid)
        tags = SeenTags(tags.number, level.in_full(tags.corners))
        placed = tags_in_place(tags, grid, settings.corner)
        seen = tags if len(tags.number) >= len(seen.number) else seen
        best = placed if len(placed) >= len(best) else best
        if len(best) >= _ENOUGH * grid.tag_count:
            break
    return seen, best


def _why_not(seen: SeenTags, grid: AprilGrid) -> tuple[Refusal, str]:
    """Return why no tags place the grid, and a sentence on those that are read."""
    if len(seen.number) == 0:
        return Refusal.NO_MARKERS, ""
    last = grid.first_id + grid.tag_count - 1
    numbers = sorted(set(seen.number.tolist()))
    detail = ids_read("Tag", numbers, str(grid.dictionary), (grid.first_id, last))
    own = sum(grid.first_id <= number <= last for number in numbers)
    if own <= len(numbers) - own:
        return Refusal.OTHER_IDS, detail
    return (Refusal.MARKERS_UNREADABLE if own == 1 else Refusal.OTHER_BOARD), detail


def _measured(
    grey: GreyPicture, grid: AprilGrid, placed: dict[int, Pixels], settings: DetectSettings
) -> Corners:
    """Fit the corners of the tags in place, and of those beside them that can be found."""
    fits = {number: _fits(grey, grid, quad, settings) for number, quad in placed.items()}
    standard = Standard.of([fit for four in fits.values() for fit in four])
    fits = {number: [standard.met_by(fit, settings.corner) for fit in four] for number, four in fits.items()}
    places = {number: _refined(placed[number], fits[number]) for number in placed}
    read, tried = set(placed), dict.fromkeys(placed, 0)
    todo = deque(expected_tags(places, grid).items())
    while todo:
        number, quad = todo.popleft()
        tried[number] = tried.get(number, 0) + 1
        side = float(np.linalg.norm(quad - np.roll(quad, 1, axis=0), axis=1).min())
        four = [
            fit
            if fit is not None
            and np.linalg.norm(fit.centre - q) < settings.corner.max_residual_squares * side
            else None
            for fit, q in zip(
                (standard.met_by(one, settings.corner) for one in _fits(grey, grid, quad, settings)),
                quad,
                strict=True,
            )
        ]
        fits[number] = four
        if all(fit is not None for fit in four):
            places[number] = _refined(quad, four)
            todo = deque((k, q) for k, q in expected_tags(places, grid).items() if k not in tried)
    index, seen_at, found = [], [], []
    for number, four in fits.items():
        row, col = divmod(number, grid.tag_cols)
        for corner, fit in enumerate(four):
            if fit is None and number not in read:
                continue
            index.append([2 * col + _OFFSETS[corner][0], 2 * row + _OFFSETS[corner][1]])
            seen_at.append(placed[number][corner] if fit is None else fit.centre)
            found.append(fit)
    corners = Corners(np.array(index, dtype=np.int64).reshape(-1, 2), np.array(seen_at).reshape(-1, 2), found)
    clear = _clear(corners, settings.corner.clear_roughness_factor)
    fits_of_clear = [fit if ok else None for fit, ok in zip(found, clear, strict=True)]
    kept = [
        ok or (int(i) // 2 + grid.tag_cols * (int(j) // 2)) in read
        for ok, (i, j) in zip(clear, corners.index, strict=True)
    ]
    return Corners(corners.index, corners.seen_at, fits_of_clear).select(np.flatnonzero(kept))


def _clear(corners: Corners, factor: float) -> list[bool]:
    """Return which corners are not much rougher than those around: nothing lies over these."""
    roughness = np.array([np.nan if fit is None else fit.roughness for fit in corners.fits])
    found = []
    for place, own in zip(corners.index, roughness, strict=True):
        near = (np.abs(corners.index - place) <= _ROUGH_CORNERS).all(axis=1) & np.isfinite(roughness)
        found.append(bool(np.isfinite(own) and own <= factor * np.median(roughness[near])))
    return found


def _fits(
    grey: GreyPicture, grid: AprilGrid, quad: Pixels, settings: DetectSettings
) -> list[SettledCorner | None]:
    """Return the fits of a tag's four corners."""
    cells = opencv_dictionary(grid.dictionary).markerSize + 2 * grid.border_cells
    return [
        fit_tag_saddle(
            grey,
            TagSaddle(
                centre=quad[k],
                edges=np.stack([quad[(k + 1) % 4] - quad[k], quad[k - 1] - quad[k]], axis=1),
                gap=grid.tag_spacing,
                border=grid.border_cells / cells,
            ),
            settings.corner,
        )
        for k in range(4)
    ]


def _refined(quad: Pixels, fits: list[SettledCorner | None]) -> Pixels:
    """Return a tag's corners, each as fitted where it is."""
    return np.array([q if fit is None else fit.centre for q, fit in zip(quad, fits, strict=True)])


def _is_smooth(corners: Corners, ok: np.ndarray, settings: DetectSettings) -> bool:
    """Tell whether corners of one kind, which are evenly spaced, lie on a smooth surface, of each kind."""
    for kind in _OFFSETS:
        own = [int(k) for k in ok if tuple(corners.index[k] % 2) == kind]
        part = corners.select(np.array(own, dtype=np.int64))
        part = Corners(part.index // 2, part.seen_at, part.fits)
        if not part.spans_a_plane():
            continue
        lattice = Lattice({(int(i), int(j)): k for k, (i, j) in enumerate(part.index)})
        if not is_smooth(lattice, part.seen_at, settings.grid):
            return False
    return True
