"""The sheet that a target is printed on: places of the board, the ruler, the captions and the code."""

import textwrap
from dataclasses import dataclass

from labcal.targets.catalogue import AnyTarget
from labcal.targets.code_fields import form_of
from labcal.targets.code_places import BLOCK_HEIGHT, BLOCK_WIDTH

RULER_MM = 100.0
"""Length of the printed ruler, between the middles of its end lines."""

CAPTION_SIZE_MM = 2.8
"""Size of the printed text (8 points)."""
CODE_UNIT_MM = 1.0
"""Length of a unit of the code's block on boards of 67 to 280 mm; it is in proportion to others."""

# All in millimetres.
_BORDER = 10.0  # most printers reach to within 5 mm of the paper's edge
_GAP_TO_RULER = 8.0  # the cut marks lie in it
_RULER_HEIGHT = 9.0  # lines and figures
_LINE_HEIGHT = 4.5
_CAPTION_WIDTH_PER_LETTER = 0.75 * CAPTION_SIZE_MM

# Of sheets with a code, the same.
_WIDEST_WITH_LEAST_CODE = 280.0
_LEAST_UNIT_MM = 0.4  # cells of a third of a millimetre, which office printers print
_LEAST_UNIT_BESIDE = 0.95  # a code that is a little smaller costs less than the height of a row of dots
_QUIET_UNITS = 4.0
_CUT_MARGIN = 4.0
_SMALL_CAPTION = 2.4
_SMALL_LINE_HEIGHT = 3.8
_SMALL_WIDTH_PER_LETTER = 0.62 * _SMALL_CAPTION


@dataclass(frozen=True)
class Rectangle:
    """An upright rectangle in the target's frame, in millimetres."""

    x_min: float
    y_min: float
    x_max: float
    y_max: float

    @property
    def width(self) -> float:
        """Extent along x."""
        return self.x_max - self.x_min

    @property
    def height(self) -> float:
        """Extent along y."""
        return self.y_max - self.y_min


@dataclass(frozen=True)
class Caption:
    """A line of text that begins at (x, y), its baseline, in the target's frame, in millimetres."""

    x: float
    y: float
    text: str


@dataclass(frozen=True)
class CodePlace:
    """Place of a print's code: upper left corner in the target's frame, and length of its unit, mm."""

    left: float
    top: float
    unit: float


@dataclass(frozen=True)
class Sheet:
    """Content of the paper, in the target's frame: millimetres, x right, y up, from dot (0, 0).

    Parameters
    ----------
    paper : Rectangle
        The whole sheet; larger than the board, so that ruler and captions stay clear of it.
    board : Rectangle
        The target itself. Where the target's margin would cut its outermost dots, or leave no rim around
        them, the board is larger than the target's extent.
    cut : Rectangle
        To be cut out: the board, and where there is a code, all that is printed.
    ruler : tuple of float
        (x, y) of the left end of the ruler, which is :data:`RULER_MM` long.
    captions : tuple of Caption
        Name, pitch, and how to print.
    caption_mm : float
        Size of their letters.
    code : CodePlace or None
        Place of the code; None on a plain sheet.
    """

    paper: Rectangle
    board: Rectangle
    cut: Rectangle
    ruler: tuple[float, float]
    captions: tuple[Caption, ...]
    caption_mm: float = CAPTION_SIZE_MM
    code: CodePlace | None = None


def lay_out_print(target: AnyTarget, copy: int | None = 0) -> Sheet:
    """Return the sheet for a target as it is printed: with a code unless it is plain, or a user's kind.

    Parameters
    ----------
    target : AnyTarget
    copy : int or None
        Number of the print, 0 for none; None for a plain print.
    """
    plain = copy is None or form_of(target) is None
    return lay_out(target) if plain else lay_out_with_code(target, copy or 0)


def lay_out(target: AnyTarget) -> Sheet:
    """Return the plain sheet for a target: the board in the middle, the ruler and the captions below it."""
    board = _board(target)
    lines = _lines(target)
    text_width = _CAPTION_WIDTH_PER_LETTER * max(len(line) for line in lines)
    # Figures stand out by a few millimetres beyond both ends of the ruler, within the border.
    width = max(board.width, RULER_MM, text_width) + 2 * _BORDER
    middle = (board.x_min + board.x_max) / 2
    left = middle - width / 2 + _BORDER
    ruler_top = board.y_min - _GAP_TO_RULER
    first_line = ruler_top - _RULER_HEIGHT - _LINE_HEIGHT
    captions = tuple(Caption(left, first_line - n * _LINE_HEIGHT, line) for n, line in enumerate(lines))
    paper = Rectangle(
        x_min=middle - width / 2,
        y_min=captions[-1].y - _BORDER,
        x_max=middle + width / 2,
        y_max=board.y_max + _BORDER,
    )
    return Sheet(paper, board, board, (left, ruler_top), captions)


def lay_out_with_code(target: AnyTarget, copy: int = 0) -> Sheet:
    """Return the sheet for a target with a code close to the board, and all else that is printed below it.

    A wide board has the code at the lower right, with ruler and captions at its left; the paper is then as
    large as that of :func:`lay_out`. Of a narrow one the code is below the board and not wider than it, so
    that a camera that sees the board can see it, too; ruler and captions are below the code. When the
    sheet is cut, the code is to stay with the board.
    """
    board = _board(target)
    room = (board.width - RULER_MM - _GAP_TO_RULER - _CUT_MARGIN) / BLOCK_WIDTH
    beside = room >= _LEAST_UNIT_BESIDE
    unit = min(_code_unit(board), room) if beside else _code_unit(board)
    width = max(board.width, RULER_MM + _CUT_MARGIN)
    middle = (board.x_min + board.x_max) / 2
    left, right = middle - width / 2, middle + width / 2
    block_left = right - unit * BLOCK_WIDTH if beside else middle - 0.5 * unit * BLOCK_WIDTH
    code = CodePlace(block_left, board.y_min - _QUIET_UNITS * unit, unit)
    below_code = code.top - unit * BLOCK_HEIGHT
    text_width = block_left - left - _GAP_TO_RULER if beside else width
    first, sizes, how = _lines(target)
    numbered = [first, f"{sizes}, copy {copy}" if copy else sizes, how]
    letters = int(text_width / _SMALL_WIDTH_PER_LETTER)
    lines = [part for line in numbered for part in textwrap.wrap(line, letters)]
    ruler_top = (board.y_min if beside else below_code) - _CUT_MARGIN
    first_line = ruler_top - _RULER_HEIGHT - _SMALL_LINE_HEIGHT
    captions = tuple(Caption(left, first_line - n * _SMALL_LINE_HEIGHT, line) for n, line in enumerate(lines))
    bottom = min(captions[-1].y, below_code)
    paper = Rectangle(left - _BORDER, bottom - _BORDER, right + _BORDER, board.y_max + _BORDER)
    cut = Rectangle(left - _CUT_MARGIN, bottom - _CUT_MARGIN, right + _CUT_MARGIN, board.y_max)
    return Sheet(paper, board, cut, (left, ruler_top), captions, _SMALL_CAPTION, code)


def _code_unit(board: Rectangle) -> float:
    """Return the length of a unit of the code: smaller on small boards, which are looked at from near."""
    if board.width > _WIDEST_WITH_LEAST_CODE:
        return CODE_UNIT_MM * board.width / _WIDEST_WITH_LEAST_CODE
    return min(CODE_UNIT_MM, max(_LEAST_UNIT_MM, board.width / BLOCK_WIDTH))


def _lines(target: AnyTarget) -> tuple[str, str, str]:
    """Return the captions: what it is, how large, and how to print it."""
    how = f"print at 100 %, check the ruler; {target.place_name} (0, 0) is at the lower left"
    return (*target.captions, how)


def _board(target: AnyTarget) -> Rectangle:
    """Return the target's extent, with a rim of half a radius at least around the outermost dots."""
    grow = max(0.0, target.least_margin_mm - target.margin_mm)
    x_min, y_min, x_max, y_max = target.extent_mm
    return Rectangle(x_min - grow, y_min - grow, x_max + grow, y_max + grow)
