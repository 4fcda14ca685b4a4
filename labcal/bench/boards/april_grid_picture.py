"""Drawn pictures of AprilGrids over all difficulties of their detection, with the truth of every corner."""

from dataclasses import replace

import numpy as np

from labcal.bench.boards.april_grid_ink import april_grid_ink
from labcal.bench.boards.board_view import (
    MOST_TRIES,
    BoardPicture,
    Limits,
    axes_at,
    blurred_view,
    random_view,
)
from labcal.bench.marks.drawn_picture import drawn
from labcal.rng import generator
from labcal.targets.april_grid import AprilGrid

TAG_PX = (20.0, 64.0)
"""Root of the area of a tag."""
NARROWEST_PX = 15.0
"""Least height of a tag that is seen aslant: one and a half pixels a cell."""
MOST_BLUR_SHARE = 0.05
"""Most blur as a share of the height of the narrowest tag: half a cell."""
KALIBR = AprilGrid(kind="aprilgrid", name="bench-kalibr", tag_cols=5, tag_rows=4, tag_mm=1.0, tag_spacing=0.3)
NARROW = AprilGrid(
    kind="aprilgrid", name="bench-narrow", tag_cols=6, tag_rows=4, tag_mm=1.0, tag_spacing=0.25,
    border_cells=1, first_id=40,
)  # fmt: skip


class AprilGridPicture(BoardPicture[AprilGrid]):
    """A picture of an AprilGrid."""

    def axes(self, number: int) -> np.ndarray:
        """Return the edges of a tag from one of its corners on, px, in columns: along the row, and up."""
        col, row = self.board.indices()[number]
        into_tag = self.board.tag_mm * np.array([1.0 - 2.0 * (col % 2), 1.0 - 2.0 * (row % 2)])
        return np.asarray(axes_at(self.exposure, self.board.points()[number, :2]) * into_tag)

    def gap_px(self, number: int) -> float:
        """Return the side of the small square at a corner, px: the root of its area."""
        return float(abs(np.linalg.det(self.axes(number))) ** 0.5 * self.board.tag_spacing)


def april_grid_picture(number: int, seed: int) -> AprilGridPicture:
    """Draw one picture; each quantity is drawn from its range.

    Pictures with an even number show a grid as Kalibr prints them; the others tags with a border of one cell.
    Grids may run out of the frame and be hidden in part. Draws are repeated until half of the corners are in
    sight.

    Parameters
    ----------
    number : int
        Of the picture.
    seed : int
    """
    random = generator(seed, "bench boards", "april grids", f"picture {number}")
    board = KALIBR if number % 2 == 0 else NARROW
    for _ in range(MOST_TRIES):
        picture = _drawn_once(board, random)
        if picture is not None:
            return picture
    raise RuntimeError("no picture of an AprilGrid that could be indexed was drawn")  # the ranges forbid it


def _drawn_once(board: AprilGrid, random: np.random.Generator) -> AprilGridPicture | None:
    """Draw a picture; None where too little of the grid is in sight."""
    places = board.points()[:, :2]
    sharp = random_view(places, TAG_PX, random)
    if sharp is None:
        return None
    corner = sharp.seen(places)
    picture = AprilGridPicture(
        np.zeros((0, 0), dtype=np.uint8), board, sharp, corner, np.zeros(len(corner), dtype=bool)
    )
    axes = np.array([picture.axes(k) for k in range(len(corner))])
    view = blurred_view(sharp, corner, axes, Limits(NARROWEST_PX, MOST_BLUR_SHARE), random)
    if view is None:
        return None
    picture = replace(picture, exposure=view.exposure, visible=view.visible, covers=view.covers)
    if not picture.countable:
        return None
    return replace(picture, picture=drawn(view.exposure, april_grid_ink(board), view.covers, random))
