"""Drawn pictures of ChArUco boards over all difficulties of detection, with the truth of every corner."""

from dataclasses import replace

import numpy as np

from labcal.bench.boards.board_view import (
    MOST_TRIES,
    BoardPicture,
    Limits,
    axes_at,
    blurred_view,
    random_view,
)
from labcal.bench.boards.charuco_ink import charuco_ink
from labcal.bench.marks.drawn_picture import drawn
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


class CharucoPicture(BoardPicture[CharucoBoard]):
    """A picture of a ChArUco board."""

    def axes(self, number: int) -> np.ndarray:
        """Return one square along x and y at a corner, px, in columns."""
        return np.asarray(self.board.square_mm * axes_at(self.exposure, self.board.points()[number, :2]))


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
    view = blurred_view(sharp, corner, axes, Limits(NARROWEST_PX, MOST_BLUR_SHARE), random)
    if view is None:
        return None
    picture = replace(picture, exposure=view.exposure, visible=view.visible, covers=view.covers)
    if not picture.countable:
        return None
    return replace(picture, picture=drawn(view.exposure, charuco_ink(board), view.covers, random))
