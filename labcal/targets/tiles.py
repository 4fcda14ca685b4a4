"""Tiles: a sheet that is larger than the paper, cut into pages that overlap."""

import math
from dataclasses import dataclass

import numpy as np

from labcal.errors import InputError
from labcal.targets.catalogue import AnyTarget
from labcal.targets.paper import PRINTER_MARGIN_MM, Paper
from labcal.targets.sheet import Rectangle, Sheet

OVERLAP_MM = 10.0
"""Width of what two neighbouring pages both show, half of it on either side of the cut."""
LABEL_MM = 7.0
"""Height of the line of text below each page's part."""
MOST_TILES = 100


@dataclass(frozen=True)
class Tile:
    """A page's part of a sheet.

    Parameters
    ----------
    col, row : int
        From 0, to the right and up.
    window : Rectangle
        What the page shows, in the target's frame, mm.
    """

    col: int
    row: int
    window: Rectangle


@dataclass(frozen=True)
class Tiling:
    """Pages of a sheet.

    Parameters
    ----------
    page_mm : (float, float)
        Width and height of a page as it is held.
    cuts_x, cuts_y : tuple of float
        Where pages are cut and joined, in the target's frame, mm; none along an axis with one page.
    tiles : tuple of Tile
        From the upper left one, row by row.
    margin_mm : float
        Rim of each page that the printer leaves bare.
    """

    page_mm: tuple[float, float]
    cuts_x: tuple[float, ...]
    cuts_y: tuple[float, ...]
    tiles: tuple[Tile, ...]
    margin_mm: float = PRINTER_MARGIN_MM

    @property
    def counts(self) -> tuple[int, int]:
        """Pages side by side, and one above the other."""
        return len(self.cuts_x) + 1, len(self.cuts_y) + 1


def tiled(
    target: AnyTarget,
    sheet: Sheet,
    paper: Paper,
    counts: tuple[int, int] | None = None,
    margin_mm: float = PRINTER_MARGIN_MM,
) -> Tiling:
    """Return the pages of a sheet; a single one where the paper holds it.

    Cuts run between the columns and rows of dots, never through a dot.

    Parameters
    ----------
    target : AnyTarget
    sheet : Sheet
        What is printed.
    paper : Paper
    counts : (int, int), optional
        Pages side by side and one above the other; as few as possible where left out.
    margin_mm : float
        Rim that the printer leaves bare.

    Raises
    ------
    InputError
        The sheet does not fit into so many pages, or needs more than :data:`MOST_TILES`.
    """
    whole = sheet.paper
    found = []
    for page in ((paper.width_mm, paper.height_mm), (paper.height_mm, paper.width_mm)):
        if counts in {None, (1, 1)} and whole.width <= page[0] + 0.01 and whole.height <= page[1] + 0.01:
            return Tiling(page, (), (), (Tile(0, 0, _page_around(whole, page)),))
        most = (page[0] - 2.0 * margin_mm, page[1] - 2.0 * margin_mm - LABEL_MM)
        x, y = (
            _cuts(ends, length, _between(places))
            for ends, length, places in zip(
                ((whole.x_min, whole.x_max), (whole.y_min, whole.y_max)),
                most,
                target.points().T[:2],
                strict=True,
            )
        )
        if x is not None and y is not None:
            found.append((page, x, y))
    fitting = [
        one
        for one in found
        if counts is None or (len(one[1]) + 1 <= counts[0] and len(one[2]) + 1 <= counts[1])
    ]
    if not fitting:
        raise InputError(_refusal(whole, paper, counts, found))
    page, x, y = min(fitting, key=lambda one: (len(one[1]) + 1) * (len(one[2]) + 1))
    return Tiling(page, x, y, _tiles(whole, x, y), margin_mm)


def tiled_room(paper: Paper, counts: tuple[int, int], margin_mm: float) -> tuple[tuple[float, float], ...]:
    """Return width and height of so many pages together, for both orientations of a page, mm."""
    return tuple(
        (
            counts[0] * (page[0] - 2.0 * margin_mm - OVERLAP_MM) + OVERLAP_MM,
            counts[1] * (page[1] - 2.0 * margin_mm - LABEL_MM - OVERLAP_MM) + OVERLAP_MM,
        )
        for page in ((paper.width_mm, paper.height_mm), (paper.height_mm, paper.width_mm))
    )


def _page_around(whole: Rectangle, page: tuple[float, float]) -> Rectangle:
    """Return a page with a sheet in its middle."""
    x, y = 0.5 * (whole.x_min + whole.x_max - page[0]), 0.5 * (whole.y_min + whole.y_max - page[1])
    return Rectangle(x, y, x + page[0], y + page[1])


def _between(places: np.ndarray) -> np.ndarray:
    """Return the places in the middle between columns (or rows) of dots, mm."""
    lines = np.unique(np.round(places, 6))
    return np.asarray(0.5 * (lines[1:] + lines[:-1]))


def _cuts(ends: tuple[float, float], most: float, between: np.ndarray) -> tuple[float, ...] | None:
    """Return the fewest cuts with which no part is longer than a page; None if there are none.

    Each part is as long as it can be; then the last cuts move back so that parts are about alike.
    """
    first, last = ends
    if most <= 2.0 * OVERLAP_MM:
        return None
    count = _fewest(ends, most, between)
    if count is None:
        return None
    cuts: list[float] = []
    for number in range(1, count):
        wanted = first + (last - first) * number / count
        begin = cuts[-1] - 0.5 * OVERLAP_MM if cuts else first
        ends_at = begin + most - 0.5 * OVERLAP_MM
        places = between[(between <= ends_at) & (between > (cuts[-1] if cuts else first))]
        # What is left must still fit into the pages that are left.
        reach = last - (count - number) * (most - OVERLAP_MM) - 0.5 * OVERLAP_MM
        good = places[places >= reach] if (places >= reach).any() else places
        if len(good) == 0:
            return None
        cuts.append(float(good[np.argmin(np.abs(good - wanted))]))
    begin = cuts[-1] - 0.5 * OVERLAP_MM if cuts else first
    return tuple(cuts) if last - begin <= most + 1e-9 else _greedy(ends, most, between)


def _fewest(ends: tuple[float, float], most: float, between: np.ndarray) -> int | None:
    cuts = _greedy(ends, most, between)
    return None if cuts is None else len(cuts) + 1


def _greedy(ends: tuple[float, float], most: float, between: np.ndarray) -> tuple[float, ...] | None:
    """Return cuts of which each is as far on as a page reaches."""
    first, last = ends
    cuts: list[float] = []
    begin = first
    while last - begin > most + 1e-9:
        places = between[(between > begin + 0.5 * OVERLAP_MM) & (between <= begin + most - 0.5 * OVERLAP_MM)]
        if len(places) == 0 or len(cuts) >= MOST_TILES:
            return None
        cuts.append(float(places[-1]))
        begin = cuts[-1] - 0.5 * OVERLAP_MM
    return tuple(cuts)


def _tiles(whole: Rectangle, x: tuple[float, ...], y: tuple[float, ...]) -> tuple[Tile, ...]:
    """Return the pages from the upper left one on."""
    half = 0.5 * OVERLAP_MM
    left, right = (whole.x_min, *(cut - half for cut in x)), (*(cut + half for cut in x), whole.x_max)
    low, high = (whole.y_min, *(cut - half for cut in y)), (*(cut + half for cut in y), whole.y_max)
    return tuple(
        Tile(col, row, Rectangle(left[col], low[row], right[col], high[row]))
        for row in reversed(range(len(low)))
        for col in range(len(left))
    )


def _refusal(
    whole: Rectangle,
    paper: Paper,
    counts: tuple[int, int] | None,
    found: list[tuple[tuple[float, float], tuple[float, ...], tuple[float, ...]]],
) -> str:
    """Return why a sheet cannot be printed so, and what would do."""
    size = f"{math.ceil(whole.width)} mm x {math.ceil(whole.height)} mm"
    pages = "a single page" if counts is None else f"{counts[0]} x {counts[1]} pages"
    if not found:
        return f"A sheet of {size} cannot be cut between dots into pages of {paper.sides}. Take larger paper."
    least = min(found, key=lambda one: (len(one[1]) + 1) * (len(one[2]) + 1))
    return (
        f"A sheet of {size} does not fit on {pages} of {paper.sides}: it takes "
        f"{len(least[1]) + 1} x {len(least[2]) + 1}. Ask for so many tiles, or take larger paper."
    )
