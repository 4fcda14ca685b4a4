"""Drawn pictures of ChArUco boards over all difficulties of detection, with the truth of every corner."""

from dataclasses import dataclass, replace

import numpy as np

from labcal.arrays import Mask, Pixels
from labcal.bench.boards.board_view import random_cover, random_view
from labcal.bench.boards.charuco_ink import charuco_ink
from labcal.bench.boards.chessboard_picture import BLUR_PX, CLEAR_PX, FRAME_PX, IN_SIGHT, MOST_TRIES, SIZE
from labcal.bench.marks.drawn_picture import Exposure, drawn
from labcal.rng import generator
from labcal.targets.charuco import CharucoBoard, MarkerDictionary, Pattern

SQUARE_PX = (16.0, 48.0)
"""Root of the area of a square."""
NARROWEST_PX = 14.0
"""Least height of a square that is seen aslant: one and a half pixels a cell of a marker."""
MOST_BLUR_SHARE = 0.08
"""Most blur as a share of the height of the narrowest square: three quarters of a cell."""
COARSE = CharucoBoard(
    kind="charuco", name="bench-coarse", squares=(9, 7), square_mm=1.0, marker_mm=0.75,
    dictionary=MarkerDictionary.DICT_4X4_50,
)  # fmt: skip
FINE = CharucoBoard(
    kind="charuco", name="bench-fine", squares=(8, 6), square_mm=1.0, marker_mm=0.75,
    dictionary=MarkerDictionary.DICT_5X5_100, first_id=20, pattern=Pattern.LEGACY,
)  # fmt: skip


@dataclass(frozen=True)
class CharucoPicture:
    """A picture, and the corners of its board.

    Attributes
    ----------
    picture : ndarray of uint8, shape (h, w)
    board : CharucoBoard
    exposure : Exposure
        How it was taken.
    corner : ndarray, shape (n, 2)
        Images of all corners, in the order of the board's indices, px.
    visible : ndarray of bool, shape (n,)
        True if a corner can be measured: within the frame, nothing over it or the edges that meet there.
    """

    picture: np.ndarray
    board: CharucoBoard
    exposure: Exposure
    corner: Pixels
    visible: Mask

    @property
    def countable(self) -> bool:
        """True if half of the corners are in sight, so that the picture should be indexed."""
        return bool(self.visible.mean() >= IN_SIGHT)

    def axes(self, number: int) -> np.ndarray:
        """Return one square along x and y at a corner, px, in columns."""
        x, y = self.board.points()[number, :2]
        q, H = self.corner[number], self.exposure.H
        w = H[2] @ [x, y, 1.0]
        return np.asarray(self.board.square_mm * (H[:2, :2] - q[:, None] * H[2, :2]) / w)


def charuco_picture(number: int, seed: int) -> CharucoPicture:
    """Draw one picture; each quantity is drawn from its range.

    Pictures with an even number show markers of 4 x 4 cells; the others 5 x 5 cells, from the id 20 on, on a
    board in OpenCV's legacy pattern. Boards may run out of the frame and be hidden in part. Draws are
    repeated until half of the corners are in sight.

    Parameters
    ----------
    number : int
        Of the picture.
    seed : int
    """
    random = generator(seed, "bench boards", "charuco", f"picture {number}")
    board = COARSE if number % 2 == 0 else FINE
    for _ in range(MOST_TRIES):
        picture = _drawn_once(board, random)
        if picture is not None:
            return picture
    raise RuntimeError(
        "no picture of a ChArUco board that could be indexed was drawn"
    )  # the ranges forbid it


def _drawn_once(board: CharucoBoard, random: np.random.Generator) -> CharucoPicture | None:
    """Draw a picture; None where too little of the board is in sight."""
    places = board.points()[:, :2]
    sharp = random_view(places, SQUARE_PX, random)
    if sharp is None:
        return None
    corner = sharp.seen(places)
    picture = CharucoPicture(
        np.zeros((0, 0), dtype=np.uint8), board, sharp, corner, np.ones(len(corner), bool)
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
    return replace(picture, picture=drawn(exposure, charuco_ink(board), covers, random))
