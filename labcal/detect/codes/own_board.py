"""The wanted board among several in one picture, known by the tags of its print."""

from collections.abc import Sequence

import cv2
import numpy as np
from jaxtyping import Float64, Shaped, UInt8

from labcal.arrays import Pixels
from labcal.detect.codes.reading import searched_picture
from labcal.detect.codes.tag_pairs import CodeBlock, find_blocks
from labcal.detect.grey import AnyPicture, GreyPicture, grey_picture
from labcal.errors import InputError
from labcal.targets.catalogue import AnyTarget
from labcal.targets.code_places import BLOCK_HEIGHT, BLOCK_WIDTH, NUMBERS, tags_of
from labcal.targets.code_text import PrintedTarget, code_text, text_number
from labcal.targets.sheet import lay_out_with_code

OwnPicture = Shaped[np.ndarray, "..."]
"""The picture that was given, of any shape, or one in grey."""

_SLACK = 0.05  # of the board's diagonal: the tags tell its far corners to some 2 % of it
_RIM = 1.5  # around a code, in its units: the board begins four away
_BAND_PX = 9  # inside the board's edge, where the paper is bare


def own_board_only(image: AnyPicture, printed: PrintedTarget) -> OwnPicture:
    """Return a picture in which other boards are hidden, where their tags are seen beside those of the print.

    Parameters
    ----------
    image : ndarray, shape (h, w), (h, w, 3) or (h, w, 4)
        uint8, uint16 or float; colour in any order.
    printed : PrintedTarget
        The print whose dots are wanted.

    Returns
    -------
    ndarray
        `image` itself where no print's tags are seen; else the picture in grey, float32, with the grey value
        of the paper in place of the code and, where another print is seen, outside the print's board.

    Raises
    ------
    InputError
        The picture shows other prints and not this one, or this one twice.
    """
    blocks = [block for block in _blocks(image) if block.is_whole]
    number = text_number(code_text(printed.target, printed.copy), NUMBERS)
    own = [block for block in blocks if block.number == number]
    if len(own) > 1:
        raise InputError(
            f"The picture shows two prints with the tags of '{printed.name}'. Show one, or print them "
            "with numbers of their own: `copy=2` of 'labcal target export'."
        )
    if not blocks:
        return image
    if not own:
        raise InputError(
            f"The picture shows the tags of another print ({_tags(blocks)}), not those of '{printed.name}' "
            f"({_tags_of(number)}). Name that print, or leave the picture out."
        )
    return _own_only(image, own[0], printed, blocks)


def own_board_where_seen(image: AnyPicture, target: AnyTarget) -> OwnPicture:
    """Return a picture as :func:`own_board_only` does; unchanged where it does not show the target's tags.

    For a target that was named: its print may be an old one without a code.

    Parameters
    ----------
    image : ndarray, shape (h, w), (h, w, 3) or (h, w, 4)
    target : AnyTarget
        Of any kind, also of one that no code describes.
    """
    try:
        number = text_number(code_text(target), NUMBERS)
    except InputError:
        return image
    blocks = [block for block in _blocks(image) if block.is_whole]
    own = [block for block in blocks if block.number == number]
    return _own_only(image, own[0], PrintedTarget(target), blocks) if len(own) == 1 else image


def _own_only(
    image: AnyPicture, own: CodeBlock, printed: PrintedTarget, blocks: Sequence[CodeBlock]
) -> GreyPicture:
    """Return a picture in grey, without the code, in which round cells may be taken for dots."""
    grey = grey_picture(image)
    grey = _hidden_outside(grey, _board(own, printed)) if len(blocks) > 1 else grey
    return _without_code(grey, own)


def _blocks(image: AnyPicture) -> list[CodeBlock]:
    searched = searched_picture(image)
    return [] if searched is None else find_blocks(searched)


def _tags(blocks: Sequence[CodeBlock]) -> str:
    return ", ".join(_tags_of(number) for number in sorted({block.number for block in blocks}))


def _tags_of(number: int) -> str:
    left, right = tags_of(number)
    return f"tags {left} and {right}"


def _board(block: CodeBlock, printed: PrintedTarget) -> Pixels:
    """Return the corners of the print's board in px, with some slack, shape (4, 2)."""
    sheet = lay_out_with_code(printed.target, printed.copy)
    board, place = sheet.board, sheet.code
    if place is None:  # which it is not
        raise InputError("The sheet has no code.")
    slack = _SLACK * float(np.hypot(board.width, board.height))
    x = np.array([board.x_min - slack, board.x_max + slack])
    y = np.array([board.y_min - slack, board.y_max + slack])
    corners: Float64[np.ndarray, "4 2"] = np.array([[x[0], y[0]], [x[1], y[0]], [x[1], y[1]], [x[0], y[1]]])
    units = (corners - [place.left, place.top]) * [1.0, -1.0] / place.unit
    return block.places(units)


def _without_code(grey: GreyPicture, block: CodeBlock) -> GreyPicture:
    """Return a picture with the grey value of the paper in place of a block of a code."""
    inside = _filled(grey.shape, _rectangle(block, _RIM))
    outer = _filled(grey.shape, _rectangle(block, 2.0 * _RIM))
    band = grey[(outer > 0) & (inside == 0)]
    return np.where(inside > 0, np.float32(np.median(band)), grey) if band.size else grey


def _rectangle(block: CodeBlock, rim: float) -> Pixels:
    """Return the corners of a block with a rim around it, in px, shape (4, 2)."""
    right, bottom = BLOCK_WIDTH + rim, BLOCK_HEIGHT + rim
    return block.places(np.array([[-rim, -rim], [right, -rim], [right, bottom], [-rim, bottom]]))


def _filled(shape: tuple[int, ...], corners: Pixels) -> UInt8[np.ndarray, "h w"]:
    """Return 1 inside a quadrangle, 0 outside; nothing of one that reaches behind the camera."""
    inside = np.zeros(shape, dtype=np.uint8)
    if np.isfinite(corners).all():
        most = 4 * max(shape)  # OpenCV's coordinates are whole numbers of 32 bits
        cv2.fillConvexPoly(inside, np.clip(np.round(corners), -most, most).astype(np.int32), 1)
    return inside


def _hidden_outside(grey: GreyPicture, corners: Pixels) -> GreyPicture:
    """Return a picture with the grey value of the paper outside a quadrangle."""
    inside = _filled(grey.shape, corners)
    if not inside.any():
        return grey
    inner = cv2.erode(inside, np.ones((_BAND_PX, _BAND_PX), dtype=np.uint8), borderValue=1)
    band = grey[(inside > 0) & (inner == 0)]
    level = np.float32(np.median(band if band.size else grey[inside > 0]))
    return np.where(inside > 0, grey, level)
