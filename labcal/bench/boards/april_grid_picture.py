"""Drawn pictures of AprilGrids over all difficulties of their detection, with the truth of every corner."""

from dataclasses import dataclass, replace

import numpy as np

from labcal.arrays import Mask, Pixels
from labcal.bench.boards.april_grid_ink import april_grid_ink
from labcal.bench.boards.board_view import random_cover, random_view
from labcal.bench.boards.chessboard_picture import BLUR_PX, CLEAR_PX, FRAME_PX, IN_SIGHT, MOST_TRIES, SIZE
from labcal.bench.marks.drawn_picture import Exposure, drawn
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


@dataclass(frozen=True)
class AprilGridPicture:
    """A picture, and the corners of its grid.

    Attributes
    ----------
    picture : ndarray of uint8, shape (h, w)
    board : AprilGrid
    exposure : Exposure
        How it was taken.
    corner : ndarray, shape (n, 2)
        Images of all corners, in the order of the grid's indices, px.
    visible : ndarray of bool, shape (n,)
        Whether a corner can be measured: within the frame, nothing over it or the edges that meet there.
    """

    picture: np.ndarray
    board: AprilGrid
    exposure: Exposure
    corner: Pixels
    visible: Mask

    @property
    def countable(self) -> bool:
        """True for a picture that should be indexed: half of the corners are in sight."""
        return bool(self.visible.mean() >= IN_SIGHT)

    def axes(self, number: int) -> np.ndarray:
        """Return the edges of a tag from one of its corners on, px, in columns: along the row, and up."""
        x, y = self.board.points()[number, :2]
        q, H = self.corner[number], self.exposure.H
        w = H[2] @ [x, y, 1.0]
        col, row = self.board.indices()[number]
        into_tag = self.board.tag_mm * np.array([1.0 - 2.0 * (col % 2), 1.0 - 2.0 * (row % 2)])
        return np.asarray((H[:2, :2] - q[:, None] * H[2, :2]) / w * into_tag)

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
    lengths = np.linalg.norm(axes, axis=1).max(axis=1)
    heights = np.abs(np.linalg.det(axes)) / lengths
    last = np.array(SIZE) - 1.0 - FRAME_PX
    inside = np.asarray(((corner > FRAME_PX) & (corner < last)).all(axis=1))
    if inside.mean() < IN_SIGHT or heights[inside].min() < NARROWEST_PX:
        return None
    most = max(BLUR_PX[0], min(BLUR_PX[1], MOST_BLUR_SHARE * float(heights[inside].min())))
    exposure = replace(sharp, blur_px=float(random.uniform(BLUR_PX[0], most)))
    cover = random_cover(corner[inside], random)
    visible = inside.copy()
    if cover is not None:
        visible &= cover.distance(corner) > CLEAR_PX + 2.0 * exposure.blur_px + 0.5 * lengths
    picture = replace(picture, exposure=exposure, visible=visible)
    if not picture.countable:
        return None
    covers = () if cover is None else (cover,)
    return replace(picture, picture=drawn(exposure, april_grid_ink(board), covers, random))
