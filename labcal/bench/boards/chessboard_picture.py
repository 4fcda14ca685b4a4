"""Drawn pictures of chessboards over all difficulties of their detection, with the truth of every corner."""

from dataclasses import dataclass

import numpy as np

from labcal.arrays import Mask, Pixels
from labcal.bench.marks.drawn_picture import PAPER, Cover, Exposure, Print, drawn, tilted
from labcal.rng import generator
from labcal.targets.chessboard import Chessboard

SIZE = (480, 360)
SQUARE_PX = (11.0, 32.0)
"""Root of the area of a square."""
NARROWEST_PX = 6.0
"""Least height of a square that is seen aslant."""
TILT_DEG = (0.0, 70.0)
BLUR_PX, MOST_BLUR_SHARE = (0.5, 3.0), 0.15
"""Range, and the most as a share of the height of the narrowest square."""
NOISE = (0.008, 0.04)
GRADIENT = (1.0, 10.0)
"""Brightest over darkest light in the picture."""
HIDDEN = 0.3
"""Most of a board's corners that something hides."""
NEIGHBOURS = 3
"""Corners in a row of an outermost line of a plain board that show where it ends."""
IN_SIGHT = 0.5
"""Share of the corners in sight of a picture that should be indexed."""
OUT_OF_FRAME = 0.35
"""Most offset of the middle of a marked board from that of the picture, of the picture's sides."""
UNLIKE_PAPER = 0.15
FOCAL = 1.3
"""Focal length over the picture's width."""
BORDER_SQUARES = 0.6
"""White paper around the squares."""
CLEAR_PX = 1.0
FRAME_PX = 6.0
"""Distance from the frame of a corner that can be measured."""
LEAST_DEPTH = 0.1
"""Of a corner, in that of the board's middle."""
MOST_TRIES = 200
WHOLE, _KINDS = 0.0, 4
"""Share hidden of every fourth picture."""
PLAIN = Chessboard(kind="chessboard", name="bench-plain", cols=9, rows=6, square_mm=1.0)
MARKED = Chessboard(
    kind="chessboard", name="bench-marked", cols=13, rows=8, square_mm=1.0, marks=((6, 4), (7, 4), (6, 5))
)


@dataclass(frozen=True)
class ChessboardPicture:
    """A picture, and the corners of its board.

    Attributes
    ----------
    picture : ndarray of uint8, shape (h, w)
    board : Chessboard
    exposure : Exposure
        How it was taken.
    corner : ndarray, shape (n, 2)
        Images of all corners, in the order of the board's indices, px.
    visible : ndarray of bool, shape (n,)
        Whether a corner can be measured: within the frame, nothing over it.
    countable : bool
        Whether the picture should be indexed: half of the corners are in sight, and what numbers them. That
        is some neighbouring corners of each outermost line of a plain board, without which nobody can tell
        which corners are seen; and the marks of a marked one, with the corners around them.
    tilt_deg : float
    """

    picture: np.ndarray
    board: Chessboard
    exposure: Exposure
    corner: Pixels
    visible: Mask
    countable: bool
    tilt_deg: float

    def axes(self, number: int) -> np.ndarray:
        """Return one square along x and y at a corner, px, in columns."""
        x, y = self.board.points()[number, :2]
        q, H = self.corner[number], self.exposure.H
        w = H[2] @ [x, y, 1.0]
        return np.asarray((H[:2, :2] - q[:, None] * H[2, :2]) / w)


def chessboard_picture(number: int, seed: int) -> ChessboardPicture:
    """Draw one picture; each quantity is drawn from its range.

    Pictures with an even number show a plain board; the others one with marks, which may run out of the
    frame. Something may hide a part of the board, but not in every fourth picture. Draws are repeated until
    the picture is one that should be indexed.

    Parameters
    ----------
    number : int
        Of the picture.
    seed : int
    """
    random = generator(seed, "bench boards", "chessboards", f"picture {number}")
    board = PLAIN if number % 2 == 0 else MARKED
    for _ in range(MOST_TRIES):
        picture = _drawn_once(board, random, WHOLE if number % _KINDS == 0 else HIDDEN)
        if picture is not None and picture.countable:
            return picture
    raise RuntimeError("no picture of a chessboard that could be indexed was drawn")  # the ranges forbid it


def _drawn_once(board: Chessboard, random: np.random.Generator, hidden: float) -> ChessboardPicture | None:
    """Draw a picture, with a share of its corners hidden at most; None where the board does not fit."""
    width = SIZE[0]
    tilt = np.radians(random.uniform(*TILT_DEG))
    square = SQUARE_PX[0] * (SQUARE_PX[1] / SQUARE_PX[0]) ** random.uniform()
    azimuth, roll, direction = random.uniform(-np.pi, np.pi, 3).tolist()
    focal = FOCAL * width
    H = tilted(float(tilt), azimuth, roll, float(focal * np.sqrt(np.cos(tilt)) / square), focal)
    middle = board.points()[:, :2].mean(axis=0)
    H = H @ np.array([[1.0, 0.0, -middle[0]], [0.0, 1.0, -middle[1]], [0.0, 0.0, 1.0]])
    spread = 0.05 if not board.marks else OUT_OF_FRAME
    x, y = (np.array(SIZE) * (0.5 + random.uniform(-spread, spread, 2))).tolist()
    H = np.array([[1.0, 0.0, x], [0.0, 1.0, y], [0.0, 0.0, 1.0]]) @ H
    p = board.points()
    if (np.concatenate([p[:, :2], np.ones((len(p), 1))], axis=1) @ H[2] <= LEAST_DEPTH).any():
        return None
    fall = np.log(GRADIENT[0] * (GRADIENT[1] / GRADIENT[0]) ** random.uniform()) / np.hypot(*SIZE)
    gradient = fall * np.array([np.cos(direction), np.sin(direction)])
    noise = NOISE[0] * (NOISE[1] / NOISE[0]) ** random.uniform()
    sharp = Exposure(SIZE, H, 0.0, gradient, float(noise))
    picture = ChessboardPicture(
        picture=np.zeros((0, 0), dtype=np.uint8),
        board=board,
        exposure=sharp,
        corner=sharp.seen(p[:, :2]),
        visible=np.zeros(len(p), dtype=bool),
        countable=False,
        tilt_deg=float(np.degrees(tilt)),
    )
    heights = np.array([_height(picture.axes(k)) for k in range(len(p))])
    last = np.array(SIZE) - 1.0 - FRAME_PX
    inside = np.asarray(((picture.corner > FRAME_PX) & (picture.corner < last)).all(axis=1))
    if not inside.any() or heights[inside].min() < NARROWEST_PX:
        return None
    most = max(BLUR_PX[0], min(BLUR_PX[1], MOST_BLUR_SHARE * float(heights[inside].min())))
    exposure = Exposure(SIZE, H, float(random.uniform(BLUR_PX[0], most)), gradient, float(noise))
    covers = _covers(picture, inside, float(random.uniform(0.0, hidden)), random) if hidden else ()
    visible = np.asarray(inside.copy())
    if covers:
        reach = (
            CLEAR_PX
            + 2.0 * exposure.blur_px
            + 0.5 * np.array([_length(picture.axes(k)) for k in range(len(p))])
        )
        visible &= np.min([cover.distance(picture.corner) for cover in covers], axis=0) > reach
    return ChessboardPicture(
        picture=drawn(exposure, _ink(board), covers, random)
        if _countable(board, visible)
        else picture.picture,
        board=board,
        exposure=exposure,
        corner=picture.corner,
        visible=visible,
        countable=_countable(board, visible),
        tilt_deg=picture.tilt_deg,
    )


def _height(axes: np.ndarray) -> float:
    """Return the least height of a square, px."""
    return float(abs(np.linalg.det(axes)) / np.linalg.norm(axes, axis=0).max())


def _length(axes: np.ndarray) -> float:
    """Return the longer side of a square, px."""
    return float(np.linalg.norm(axes, axis=0).max())


def _countable(board: Chessboard, visible: Mask) -> bool:
    """Tell whether the corners in sight determine their numbers."""
    index = board.indices()
    if not board.marks:
        seen = np.zeros((board.cols, board.rows), dtype=bool)
        seen[index[:, 0], index[:, 1]] = visible
        lines = (seen[0], seen[-1], seen[:, 0], seen[:, -1])
        ends = [np.lib.stride_tricks.sliding_window_view(line, NEIGHBOURS).all(axis=1) for line in lines]
        return bool(visible.mean() >= IN_SIGHT and all(end.any() for end in ends))
    around = np.zeros(len(index), dtype=bool)
    for i, j in board.marks:
        around |= (np.abs(index - (np.array([i, j]) - 0.5)) < 1.0).all(axis=1)
    return bool(visible.mean() >= IN_SIGHT and visible[around].all())


def _ink(board: Chessboard) -> Print:
    """Return the print: squares, marks and white paper around them; unit: mm."""

    def ink(x: np.ndarray, y: np.ndarray) -> np.ndarray:
        with np.errstate(invalid="ignore"):  # NaN is behind the camera
            i, j = (np.floor(np.nan_to_num(place, nan=-99.0)).astype(int) + 1 for place in (x, y))
            black = 0.5 + 0.5 * _waves(x) * _waves(y)
            for mark in board.marks:
                round_ = np.hypot(x - mark[0] + 0.5, y - mark[1] + 0.5) < 0.5 * board.mark_share
                black = np.where(round_, 1.0 - black, black)
            on_board = (i >= 0) & (j >= 0) & (i <= board.cols) & (j <= board.rows)
            x_min, y_min, x_max, y_max = board.extent_mm
            paper = (
                (x > x_min - BORDER_SQUARES)
                & (x < x_max + BORDER_SQUARES)
                & (y > y_min - BORDER_SQUARES)
                & (y < y_max + BORDER_SQUARES)
            )
        return np.asarray(np.where(on_board, black, np.where(paper, 0.0, 0.6)))

    return ink


def _waves(x: np.ndarray) -> np.ndarray:
    """Return 1 in every other square along an axis and -1 in the others, linear across a sample at an edge.

    An edge along the rows of samples would else be off by up to half of one.
    """
    down, across = np.gradient(x)
    nearest = np.rint(x)
    off = 2.0 * (x - nearest) / np.hypot(down, across)
    sign = 1.0 - 2.0 * np.mod(nearest, 2.0)
    return np.asarray(-sign * np.clip(off, -1.0, 1.0))


def _covers(
    picture: ChessboardPicture, inside: Mask, wanted: float, random: np.random.Generator
) -> tuple[Cover, ...]:
    """Return a rectangle at random that hides a share of the corners."""
    middle = picture.corner[inside][int(random.integers(int(inside.sum())))]
    turn = float(random.uniform(-np.pi, np.pi))
    shape = np.array([1.0, random.uniform(0.4, 2.5)])
    level = random.uniform(0.0, 1.0)
    if abs(level - PAPER) < UNLIKE_PAPER:
        level = PAPER - UNLIKE_PAPER if random.uniform() < PAPER else PAPER + UNLIKE_PAPER
    cover = None
    for size in np.geomspace(4.0, 400.0, 60):
        wider = Cover(middle, size * shape, turn, float(level))
        if (wider.distance(picture.corner[inside]) < 0.0).sum() > wanted * len(inside):
            break
        cover = wider
    return () if cover is None else (cover,)
