"""The sheet of a print beside the target: its extent, and the outlines of code, ruler and captions."""

import numpy as np
from jaxtyping import Float64
from matplotlib.path import Path as Outline
from matplotlib.textpath import TextPath
from matplotlib.transforms import Affine2D

from labcal.targets.artwork import HAIRLINE_MM, own_style, print_text, ruler_marks
from labcal.targets.polygons import as_polygons
from labcal.targets.print_code import print_code
from labcal.targets.print_scale import as_designed
from labcal.targets.scaled_print import ScaledPrint
from labcal.targets.sheet import Rectangle, Sheet, lay_out_print
from labcal.targets.target import PrintableTarget

_SQUARE = [Outline.MOVETO, Outline.LINETO, Outline.LINETO, Outline.LINETO, Outline.CLOSEPOLY]


def cut_sheet(target: PrintableTarget, number: int) -> Rectangle:
    """Return the edges of a print as it is cut out, mm in the target's frame, at the scale of the print.

    Parameters
    ----------
    target : PrintableTarget
        As designed, or with the scale of its print.
    number : int
        Of the print.
    """
    cut = lay_out_print(as_designed(target), number).cut
    x, y = target.scale_x_y.tolist() if isinstance(target, ScaledPrint) else (1.0, 1.0)
    return Rectangle(cut.x_min * x, cut.y_min * y, cut.x_max * x, cut.y_max * y)


def beside_target(target: PrintableTarget, number: int) -> list[Float64[np.ndarray, "corners 2"]]:
    """Return the outlines of all that a print shows beside the target, closed, mm as designed.

    Parameters
    ----------
    target : PrintableTarget
    number : int
        Of the print.

    Raises
    ------
    InputError
        The description does not fit into a code.
    """
    design = as_designed(target)
    sheet, text = lay_out_print(design, number), print_text(design, number)
    outlines = [_ruler(sheet), *_letters(sheet)]
    if text is not None and sheet.code is not None:
        outlines.append(print_code(text).outlines(sheet.code.left, sheet.code.top, sheet.code.unit))
    return [polygon for outline in outlines for polygon in as_polygons(outline)]


def _ruler(sheet: Sheet) -> Outline:
    """Return the lines of the ruler as narrow rectangles."""
    half, boxes = 0.5 * HAIRLINE_MM, []
    for (x0, x1), (y0, y1) in ruler_marks(sheet):
        across = (half, 0.0) if x0 == x1 else (0.0, half)
        low = np.minimum([x0, y0], [x1, y1]) - across
        high = np.maximum([x0, y0], [x1, y1]) + across
        boxes.append([low, [high[0], low[1]], high, [low[0], high[1]], low])
    return Outline(np.array(boxes).reshape(-1, 2), np.tile(_SQUARE, len(boxes)))


def _letters(sheet: Sheet) -> list[Outline]:
    """Return the outlines of the captions' letters."""
    with own_style():
        return [
            TextPath((0.0, 0.0), line.text, size=sheet.caption_mm).transformed(
                Affine2D().translate(line.x, line.y)
            )
            for line in sheet.captions
        ]
