"""A picture with what detection made of it drawn on top."""

import cv2
import numpy as np
from jaxtyping import UInt8

from labcal.detect.dots import PictureDots
from labcal.detect.flags import DotFlag
from labcal.detect.grey import AnyPicture, grey_picture
from labcal.detect.marks.picture_marks import PictureMarks
from labcal.targets.board_set import BoardSet
from labcal.targets.grid import DotGrid, GridIndex
from labcal.targets.target import Target

Colour = tuple[int, int, int]

# Red, green, blue.
_COLOURS: dict[DotFlag, Colour] = {
    DotFlag.OK: (40, 200, 60),
    DotFlag.BEYOND_GRID: (60, 150, 255),
    DotFlag.CUT: (255, 150, 0),
    DotFlag.HIDDEN: (150, 150, 150),
    DotFlag.SATURATED: (255, 255, 0),
    DotFlag.BLURRED: (180, 90, 255),
    DotFlag.BAD_FIT: (255, 40, 40),
    DotFlag.NO_ID: (255, 60, 220),
}
_AXES: tuple[Colour, Colour] = ((255, 60, 60), (255, 220, 0))
_UNCERTAINTY: Colour = (0, 230, 230)
_ELLIPSE = 0.4  # of a dot's radius, wanted of the ellipse of its standard deviation
_TIMES = [m * 10**k for k in range(6) for m in (1, 2, 5)]
_SUBPIXEL = 4  # bits of cv2's fixed-point coordinates
_LABEL_ROOM = 5.0  # label heights between labelled dots


def draw_overlay(image: AnyPicture, dots: PictureDots, target: Target) -> UInt8[np.ndarray, "h w 3"]:
    """Draw outlines, centres, ids, the target's axes and the flags of unused dots over a picture.

    Parameters
    ----------
    image : ndarray
        The picture the dots were found in.
    dots : PictureDots
        What was found.
    target : Target
        Whose rings, or else whose outermost dots, give the axes.

    Returns
    -------
    ndarray, shape (h, w, 3)
        Red, green, blue.

    Raises
    ------
    InputTypeError, InputError
        `image` is no picture.
    """
    canvas = grey_canvas(image)
    if canvas.size == 0:
        return canvas
    thick = stroke(canvas)
    for i, flag in enumerate(dots.flag):
        draw_dot(canvas, dots, i, _COLOURS[flag], thick)
    draw_uncertainty(canvas, dots, thick)
    for part, board in _boards(dots, target):
        _draw_axes(canvas, part, board, 2 * thick)
        _draw_labels(canvas, part, thick)
        _draw_name(canvas, part, board if part is not dots else None, thick)
    if dots.refusal is not None:
        draw_text(
            canvas,
            f"refused: {dots.refusal}",
            (10 * thick, 30 * thick),
            0.9 * thick,
            _COLOURS[DotFlag.BAD_FIT],
        )
    return canvas


def _boards(dots: PictureDots, target: Target) -> list[tuple[PictureDots, Target]]:
    """Return the dots of each board; of a single one, and where none is found, all of them."""
    if dots.own is None or not dots.indexed or not isinstance(target, BoardSet):
        return [(dots, target)]
    return [(dots.of_board(board.name), board) for board in target.targets]


def _draw_name(canvas: np.ndarray, dots: PictureDots, board: Target | None, thick: int) -> None:
    """Write the name of one of several boards above its dots."""
    if board is None or len(dots.flag) == 0:
        return
    x, y = dots.seen_at[:, 0].min(), dots.seen_at[:, 1].min() - 20.0 * thick
    place = (int(max(x, 0.0)), int(max(y, 16.0 * thick)))
    draw_text(canvas, board.name, place, 0.6 * thick, _COLOURS[DotFlag.OK])


def grey_canvas(image: AnyPicture) -> UInt8[np.ndarray, "h w 3"]:
    """Return a picture in grey, from its darkest to its brightest value, to draw on."""
    grey = grey_picture(image)
    low, high = (float(grey.min()), float(grey.max())) if grey.size else (0.0, 0.0)
    scaled = (grey - low) * (255 / (high - low)) if high > low else np.zeros_like(grey)
    return np.asarray(cv2.cvtColor(scaled.astype(np.uint8), cv2.COLOR_GRAY2RGB))


def stroke(canvas: np.ndarray) -> int:
    """Return the width of lines, px."""
    return max(1, round(int(max(canvas.shape)) / 1000))


def _fixed(q: np.ndarray) -> tuple[int, int]:
    """Return a position in cv2's fixed-point units."""
    x, y = np.clip(np.round(q * 2**_SUBPIXEL), -(2**28), 2**28)
    return int(x), int(y)


def draw_dot(
    canvas: np.ndarray, dots: PictureDots | PictureMarks, i: int, colour: Colour, thick: int
) -> None:
    """Draw the outline and a cross at the centre, or a diagonal cross where nothing was measured."""
    centre = dots.seen_at[i]
    radius = 6.0 * thick
    if np.isfinite(dots.outline[i]).all():
        eigenvalues, vectors = np.linalg.eigh(dots.outline[i])
        angle = np.linspace(0, 2 * np.pi, 73)
        circle = np.stack([np.cos(angle), np.sin(angle)], axis=-1) * np.sqrt(eigenvalues)
        points = np.array([_fixed(q) for q in centre + circle @ vectors.T], dtype=np.int32)
        cv2.polylines(
            canvas,
            [points],
            isClosed=True,
            color=colour,
            thickness=thick,
            lineType=cv2.LINE_AA,
            shift=_SUBPIXEL,
        )
        radius = 0.4 * float(np.sqrt(eigenvalues[0]))
    measured = np.isfinite(dots.position[i]).all()
    arms = np.array([[1.0, 0.0], [0.0, 1.0]]) if measured else np.array([[0.7, 0.7], [0.7, -0.7]])
    for arm in radius * arms:
        ends = (_fixed(centre - arm), _fixed(centre + arm))
        cv2.line(canvas, *ends, colour, thick, cv2.LINE_AA, _SUBPIXEL)


def draw_uncertainty(canvas: np.ndarray, dots: PictureDots | PictureMarks, thick: int) -> None:
    """Draw the standard deviations of the positions as ellipses, magnified so that they can be seen."""
    measured = np.isfinite(dots.covariance).all(axis=(1, 2)) & np.isfinite(dots.outline).all(axis=(1, 2))
    if not measured.any():
        return
    variances, axes = np.linalg.eigh(dots.covariance[measured])
    sigmas = np.sqrt(np.maximum(variances, 0.0))
    radius = float(np.median(np.linalg.det(dots.outline[measured]) ** 0.25))
    wanted = _ELLIPSE * radius / max(float(np.percentile(sigmas[:, 1], 75)), 1e-9)
    times = int(max((k for k in _TIMES if k <= wanted), default=1))
    for q, (minor, major), axis in zip(dots.position[measured], times * sigmas, axes, strict=True):
        angle = float(np.degrees(np.arctan2(axis[1, 1], axis[0, 1])))
        size = _fixed(np.array([major, minor]))
        cv2.ellipse(canvas, _fixed(q), size, angle, 0, 360, _UNCERTAINTY, thick, cv2.LINE_AA, shift=_SUBPIXEL)
    place = (10 * thick, canvas.shape[0] - 10 * thick)
    draw_text(canvas, f"ellipses: standard deviation x {times}", place, 0.5 * thick, _UNCERTAINTY)


def _draw_axes(canvas: np.ndarray, dots: PictureDots, target: Target, thick: int) -> None:
    """Draw arrows from the origin ring to the x and the y ring, or from corner to corner of the grid."""
    places = {
        tuple(index): q
        for index, q, known in zip(dots.index.tolist(), dots.seen_at, dots.has_id, strict=True)
        if known
    }
    start, *ends = _axis_ends(target)
    origin = places.get(start)
    for index, name, colour in zip(ends, "xy", _AXES, strict=True):
        end = places.get(index)
        if origin is None or end is None:
            continue
        cv2.arrowedLine(canvas, _fixed(origin), _fixed(end), colour, thick, cv2.LINE_AA, _SUBPIXEL, 0.03)
        along = (end - origin) / max(float(np.linalg.norm(end - origin)), 1.0)
        beyond = end + 18 * thick * along
        draw_text(canvas, name, (int(beyond[0]), int(beyond[1])), 0.5 * thick, colour)


def _axis_ends(target: Target) -> tuple[GridIndex, ...]:
    """Return (col, row) of where the axes begin, of x's end and of y's end."""
    if isinstance(target, DotGrid) and target.rings is not None:
        return target.ring_indices
    return ((0, 0), (target.cols - 1, 0), (0, target.rows - 1))


def _draw_labels(canvas: np.ndarray, dots: PictureDots, thick: int) -> None:
    """Write the ids, only as many as there is room for, and the flag of every dot that is not used."""
    size = 0.4 * thick
    height = 12.0 * thick
    step = _label_step(dots, height)
    for i, flag in enumerate(dots.flag):
        col, row = (int(k) for k in dots.index[i])
        name = f"{col},{row}" if dots.has_id[i] else ""
        if flag in (DotFlag.OK, DotFlag.BEYOND_GRID):
            if col % step or row % step:
                continue
        elif not dots.indexed:
            continue
        else:
            name = f"{name} {flag}".strip()
        reach = (
            np.sqrt(np.diag(dots.outline[i]))
            if np.isfinite(dots.outline[i]).all()
            else np.full(2, height / 2)
        )
        x = dots.seen_at[i, 0] + 0.75 * reach[0]
        y = dots.seen_at[i, 1] - 0.75 * reach[1]
        width = 0.6 * height * len(name)
        place = (int(min(x, canvas.shape[1] - width)), int(np.clip(y, height, canvas.shape[0] - 4)))
        draw_text(canvas, name, place, size, _COLOURS[flag])


def _label_step(dots: PictureDots, height: float) -> int:
    """Return every how many-th column and row is labelled so that labels do not touch."""
    known = dots.seen_at[dots.has_id]
    if len(known) < 2:  # noqa: PLR2004 - no distance to take
        return 1
    extent = np.ptp(known, axis=0)
    spacing = float(np.sqrt(max(extent[0] * extent[1], 1.0) / len(known)))
    return max(1, int(np.ceil(_LABEL_ROOM * height / spacing)))


def draw_text(canvas: np.ndarray, text: str, place: tuple[int, int], size: float, colour: Colour) -> None:
    """Write text with a dark rim, readable on any ground."""
    thin, (x, y) = max(1, round(size * 1.5)), place
    rim = [(x + i, y + j) for i in (-1, 0, 1) for j in (-1, 0, 1) if i or j]  # thicker letters are wider
    for at, ink in (*((at, (0, 0, 0)) for at in rim), (place, colour)):
        cv2.putText(canvas, text, at, cv2.FONT_HERSHEY_SIMPLEX, size, ink, thin, cv2.LINE_AA)
