"""A sheet with all pictures of a shoot, their main properties and their dots."""

import math
from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from jaxtyping import Int64, UInt8
from PIL import Image, ImageDraw, ImageFont

_WIDEST = 3900  # px of the sheet
_LARGEST = 4e7  # px in all: a sheet is opened by ordinary programs
_THUMBNAIL_WIDTHS = (480, 400, 320, 240, 180)
_ASPECT = 1.5  # width over height that the sheet comes near
_GAP, _MARGIN, _LINE, _HEADING = 12, 24, 20, 64
_LINES = 3
_GROUND, _INK, _QUIET, _BAD = (250, 249, 246), (27, 32, 37), (100, 108, 116), (190, 40, 32)
_EMPTY, _FULL = np.array([232, 229, 222]), np.array([29, 95, 166])


@dataclass(frozen=True)
class SheetTile:
    """One picture on the sheet."""

    thumbnail: UInt8[np.ndarray, "h w 3"] | None
    """None where the picture cannot be read."""
    lines: tuple[str, ...]
    """Lines below the picture; the first one in ink."""
    refused: bool
    """True if the picture is refused: its frame and its last line are red."""


@dataclass(frozen=True)
class SheetCoverage:
    """Image coverage of a camera: the cells in which dots were found."""

    title: str
    size: tuple[int, int]
    """Width and height of the camera's pictures, px."""
    cells: Int64[np.ndarray, "rows columns"]
    """Dots in each cell of a grid over the picture."""


@dataclass(frozen=True)
class SheetLayout:
    """Layout of the tiles: number in a row, and size."""

    columns: int
    rows: int
    box: tuple[int, int]
    """Width and height that a thumbnail has to fit into, px."""


def plan_layout(pictures: int, together: int, aspect: float) -> SheetLayout:
    """Choose the size of thumbnails and their number in a row.

    Parameters
    ----------
    pictures : int
        How many there are.
    together : int
        So many successive ones (the cameras of a view) stand in the same row.
    aspect : float
        Height over width of the tallest picture.
    """
    together = max(1, together)
    layout = SheetLayout(1, max(1, pictures), (_THUMBNAIL_WIDTHS[-1], round(_THUMBNAIL_WIDTHS[-1] * aspect)))
    for width in _THUMBNAIL_WIDTHS:
        height = max(1, round(width * aspect))
        tile = (width + _GAP, height + _LINES * _LINE + _GAP)
        ideal = math.sqrt(max(1, pictures) * _ASPECT * tile[1] / tile[0])
        groups = min(max(1, round(ideal / together)), max(1, (_WIDEST - 2 * _MARGIN) // (tile[0] * together)))
        columns = min(groups * together, max(1, (_WIDEST - 2 * _MARGIN) // tile[0]), max(1, pictures))
        layout = SheetLayout(columns, math.ceil(max(1, pictures) / columns), (width, height))
        if layout.columns * layout.rows * tile[0] * tile[1] <= _LARGEST:
            break
    return layout


def contact_sheet(
    heading: str, layout: SheetLayout, tiles: Sequence[SheetTile], coverages: Sequence[SheetCoverage]
) -> UInt8[np.ndarray, "h w 3"]:
    """Draw the sheet.

    Parameters
    ----------
    heading : str
    layout : SheetLayout
        From :func:`plan_layout`; thumbnails fit into its box.
    tiles : sequence of SheetTile
        In reading order.
    coverages : sequence of SheetCoverage
        One a camera, drawn below the tiles.

    Returns
    -------
    ndarray, shape (h, w, 3)
        Red, green, blue.
    """
    wide, high = layout.box[0] + _GAP, layout.box[1] + _LINES * _LINE + _GAP
    across = min(len(coverages), max(1, (_WIDEST - 2 * _MARGIN) // wide))
    down = math.ceil(len(coverages) / across) if across else 0
    width = 2 * _MARGIN + max(layout.columns, across) * wide - _GAP
    top = _MARGIN + _HEADING + layout.rows * high + 2 * _GAP
    sheet = Image.new("RGB", (width, top + down * high + _MARGIN), _GROUND)
    draw = ImageDraw.Draw(sheet)
    draw.text((_MARGIN, _MARGIN), heading, _INK, ImageFont.load_default(26))
    for number, tile in enumerate(tiles):
        row, column = divmod(number, layout.columns)
        corner = (_MARGIN + column * wide, _MARGIN + _HEADING + row * high)
        _draw_tile(sheet, draw, tile, corner, layout.box)
    for number, covered in enumerate(coverages):
        row, column = divmod(number, across)
        _draw_coverage(draw, covered, (_MARGIN + column * wide, top + row * high), layout.box)
    return np.asarray(sheet)


def _draw_tile(
    sheet: Image.Image,
    draw: ImageDraw.ImageDraw,
    tile: SheetTile,
    corner: tuple[int, int],
    box: tuple[int, int],
) -> None:
    """Draw a picture with its lines below."""
    x, y = corner
    if tile.thumbnail is None:
        draw.rectangle((x, y, x + box[0] - 1, y + box[1] - 1), fill=(225, 222, 215))
        draw.text(
            (x + box[0] / 2, y + box[1] / 2), "not readable", _BAD, ImageFont.load_default(20), anchor="mm"
        )
    else:
        sheet.paste(Image.fromarray(tile.thumbnail), corner)
    shown = box if tile.thumbnail is None else tile.thumbnail.shape[1::-1]
    if tile.refused:
        draw.rectangle((x, y, x + shown[0] - 1, y + shown[1] - 1), outline=_BAD, width=4)
    for number, line in enumerate(tile.lines[:_LINES]):
        colour = _INK if number == 0 else _QUIET
        if tile.refused and number == len(tile.lines) - 1:
            colour = _BAD
        _write(draw, (x, y + box[1] + 3 + number * _LINE), line, box[0], colour)


def _draw_coverage(
    draw: ImageDraw.ImageDraw, covered: SheetCoverage, corner: tuple[int, int], box: tuple[int, int]
) -> None:
    """Draw the cells of a camera's picture, the darker the more dots, with their counts."""
    x, y = corner
    scale = min(box[0] / covered.size[0], box[1] / covered.size[1])
    rows, columns = covered.cells.shape
    cell = (covered.size[0] * scale / columns, covered.size[1] * scale / rows)
    most = max(int(covered.cells.max()), 1)
    for (row, column), count in np.ndenumerate(covered.cells):
        # Even one dot must look different from none.
        share = 0.0 if count == 0 else 0.2 + 0.8 * count / most
        red, green, blue = (int(level) for level in np.rint(_EMPTY + share * (_FULL - _EMPTY)))
        left, upper = x + column * cell[0], y + row * cell[1]
        draw.rectangle((left, upper, left + cell[0] - 2, upper + cell[1] - 2), fill=(red, green, blue))
        ink = (255, 255, 255) if share > 0.5 else _QUIET  # noqa: PLR2004 - readable on either side
        middle = (left + cell[0] / 2 - 1, upper + cell[1] / 2 - 1)
        draw.text(middle, str(count), ink, ImageFont.load_default(min(14, cell[1] / 2)), anchor="mm")
    _write(draw, (x, y + box[1] + 3), covered.title, box[0], _INK)


def _write(
    draw: ImageDraw.ImageDraw, place: tuple[int, int], text: str, width: int, colour: tuple[int, int, int]
) -> None:
    """Write a line, cut where it does not fit."""
    font = ImageFont.load_default(15)
    while len(text) > 1 and draw.textlength(text, font) > width:
        text = text.removesuffix("...")[:-1].rstrip() + "..." if len(text) > 4 else text[:-1]  # noqa: PLR2004 - dots
    draw.text(place, text, colour, font)
