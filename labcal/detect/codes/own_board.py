"""The wanted board among several in one picture, told by the tags of its print."""

from collections.abc import Sequence

import cv2
import numpy as np
from jaxtyping import Float64

from labcal.arrays import Pixels
from labcal.detect.codes.reading import searched_picture
from labcal.detect.codes.tag_pairs import CodeBlock, find_blocks
from labcal.detect.grey import AnyPicture, GreyPicture, grey_picture
from labcal.errors import InputError
from labcal.targets.catalogue import AnyTarget
from labcal.targets.code_places import NUMBERS, tags_of
from labcal.targets.code_text import PrintedTarget, code_text, text_number
from labcal.targets.sheet import lay_out_with_code

_SLACK = 0.05  # of the board's diagonal: the tags tell its far corners to some 2 % of it
_BAND_PX = 9  # inside the board's edge, where the paper is bare


def own_board_only(image: AnyPicture, printed: PrintedTarget) -> AnyPicture:
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
        `image` itself where no other print is seen; else the picture in grey, float32, with one grey value
        outside the print's board.

    Raises
    ------
    InputError
        The picture shows other prints and not this one, or this one twice.
    """
    blocks = [block for block in _blocks(image) if block.is_whole]
    number = text_number(code_text(printed.target, printed.copy), NUMBERS)
    own = [block for block in blocks if block.number == number]
    others = [block for block in blocks if block.number != number]
    if len(own) > 1:
        raise InputError(
            f"The picture shows two prints with the tags of '{printed.name}'. Show one of them, or print them "
            "with numbers of their own: 'labcal target export --copy 2'."
        )
    if not others:
        return image
    if not own:
        raise InputError(
            f"The picture shows the tags of another print ({_tags(others)}) and not those of '{printed.name}' "
            f"({_tags_of(number)}). Name that print, or leave the picture out."
        )
    return _hidden_outside(grey_picture(image), _board(own[0], printed))


def own_board_where_seen(image: AnyPicture, target: AnyTarget) -> AnyPicture:
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
    if len(own) != 1 or len(blocks) == 1:
        return image
    return _hidden_outside(grey_picture(image), _board(own[0], PrintedTarget(target)))


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


def _hidden_outside(grey: GreyPicture, corners: Pixels) -> GreyPicture:
    """Return a picture with the grey value of the paper outside a quadrangle."""
    if not np.isfinite(corners).all():
        return grey
    inside = np.zeros(grey.shape, dtype=np.uint8)
    most = 4 * max(grey.shape)  # OpenCV's coordinates are whole numbers of 32 bits
    cv2.fillConvexPoly(inside, np.clip(np.round(corners), -most, most).astype(np.int32), 1)
    if not inside.any():
        return grey
    inner = cv2.erode(inside, np.ones((_BAND_PX, _BAND_PX), dtype=np.uint8), borderValue=1)
    band = grey[(inside > 0) & (inner == 0)]
    level = np.float32(np.median(band if band.size else grey[inside > 0]))
    return np.where(inside > 0, grey, level)
