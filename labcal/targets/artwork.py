"""Targets as SVG, PDF and PNG at exact scale, with a ruler to check the print by."""

import io
import math
from collections.abc import Iterator
from contextlib import contextmanager
from dataclasses import dataclass, field
from enum import StrEnum
from pathlib import Path as FilePath

import matplotlib as mpl
import numpy as np
from matplotlib.axes import Axes
from matplotlib.backends.backend_agg import FigureCanvasAgg
from matplotlib.figure import Figure
from matplotlib.patches import PathPatch
from matplotlib.patches import Rectangle as RectanglePatch
from matplotlib.path import Path as Outline

from labcal.errors import InputError, UnknownNameError
from labcal.paths import AnyPath, as_path
from labcal.run.claims import FileOutput
from labcal.run.file_kinds import FileKind
from labcal.run.file_marks import PDF_COMMENT, PNG_TEXT, XML_COMMENT
from labcal.run.machine import memory_bytes
from labcal.run.outputs import write_file
from labcal.run.overwriting import require_file_place
from labcal.targets.catalogue import AnyTarget
from labcal.targets.code_fields import form_of
from labcal.targets.code_text import code_text
from labcal.targets.print_code import print_code
from labcal.targets.shapes import printed_outlines
from labcal.targets.sheet import RULER_MM, Sheet, lay_out_print
from labcal.wording import clipped

MM_PER_INCH = 25.4
POINTS_PER_INCH = 72
DEFAULT_DPI = 300

HAIRLINE_MM = 0.15
"""Width of lines."""
_BYTES_PER_PIXEL = 8  # the canvas, and the copy that is compressed
_ASSUMED_MEMORY = 4 * 2**30  # where the system does not tell


class ArtworkFormat(StrEnum):
    """The formats, named by the ending of the file."""

    SVG = "svg"
    PDF = "pdf"
    PNG = "png"


_BEGINNINGS = {
    ArtworkFormat.SVG: b"<?xml",
    ArtworkFormat.PDF: b"%PDF",
    ArtworkFormat.PNG: b"\x89PNG",
}
_MARKS = {
    ArtworkFormat.SVG: XML_COMMENT,
    ArtworkFormat.PDF: PDF_COMMENT,
    ArtworkFormat.PNG: PNG_TEXT,
}
_UNDATED = {
    ArtworkFormat.SVG: {"Date": None},
    ArtworkFormat.PDF: {"CreationDate": None},
    ArtworkFormat.PNG: {},
}


@dataclass(frozen=True)
class Artwork:
    """A drawn target: the content of the file, the size of the paper, and the pixels an inch of a PNG."""

    content: bytes = field(repr=False)
    width_mm: float
    height_mm: float
    dpi: int | None
    code: str | None = field(default=None, repr=False)
    """Text of the QR code on the print; None on a plain one."""


def export_artwork(
    target: AnyTarget,
    path: AnyPath,
    *,
    dpi: int | None = None,
    force: bool = False,
    copy: int | None = 0,
) -> Artwork:
    """Write a target as a file to print; the ending of the name determines the format.

    Parameters
    ----------
    target : AnyTarget
        The target.
    path : str or os.PathLike
        The file, ending in ``.svg``, ``.pdf`` or ``.png``.
    dpi : int, optional
        Pixels an inch of a PNG, 300 where left out.
    force : bool
        Replace a file that labcal wrote.
    copy : int or None
        Number of the print in its code, where several prints of one design are to be distinguished; None for
        a plain print without a code, as are those of kinds of the user's.

    Raises
    ------
    InputError
        The ending is not known, `dpi` is given for a format without pixels, or the PNG would not fit into
        memory; or the description does not fit into a code (see :func:`labcal.targets.code_text.code_text`).
    OutputError
        The file exists or cannot be written.
    """
    path = as_path(path)
    kind = _format_of(path)
    require_file_place(path, force=force)
    artwork = draw_artwork(target, kind, dpi=dpi, copy=copy)
    write_file(path, artwork.content, kind=_file_kind(kind), force=force)
    return artwork


def artwork_output(path: AnyPath) -> FileOutput:
    """Return a file to print as an output of a command; see :func:`export_artwork`.

    Raises
    ------
    UnknownNameError
        The ending is not known.
    """
    path = as_path(path)
    return FileOutput(path, _file_kind(_format_of(path)))


def _file_kind(kind: ArtworkFormat) -> FileKind:
    """Return the kind of files of a format."""
    return FileKind(
        f"a drawing in {kind.upper()}", lambda content: content.startswith(_BEGINNINGS[kind]), _MARKS[kind]
    )


def _format_of(path: FilePath) -> ArtworkFormat:
    """Return the format that a name's ending means."""
    kind = path.suffix.removeprefix(".").lower()
    if kind not in set(ArtworkFormat):
        raise UnknownNameError("artwork format (the ending of the file's name)", kind, ArtworkFormat)
    return ArtworkFormat(kind)


def draw_artwork(
    target: AnyTarget, kind: ArtworkFormat, *, dpi: int | None = None, copy: int | None = 0
) -> Artwork:
    """Return a target as the content of a file; see :func:`export_artwork`."""
    if kind is not ArtworkFormat.PNG and dpi is not None:
        raise InputError(
            f"A resolution (dpi) means nothing to {kind.upper()}, which has no pixels; leave it out."
        )
    text, sheet = print_text(target, copy), lay_out_print(target, copy)
    used_dpi = _resolution(sheet, dpi) if kind is ArtworkFormat.PNG else None
    width, height = _paper_size(sheet, used_dpi)
    resolution = used_dpi or POINTS_PER_INCH
    with own_style():
        figure = Figure(
            figsize=(width / MM_PER_INCH, height / MM_PER_INCH), dpi=resolution, facecolor="white"
        )
        FigureCanvasAgg(figure)
        axes = figure.add_axes((0.0, 0.0, 1.0, 1.0))
        axes.set_axis_off()
        axes.set_xlim(sheet.paper.x_min, sheet.paper.x_min + width)
        axes.set_ylim(sheet.paper.y_max - height, sheet.paper.y_max)
        draw_sheet(axes, target, sheet, text)
        buffer = io.BytesIO()
        figure.savefig(buffer, format=kind.value, dpi=resolution, metadata=_UNDATED[kind])
    return Artwork(buffer.getvalue(), width, height, used_dpi, text)


def print_text(target: AnyTarget, copy: int | None = 0) -> str | None:
    """Return the text of the code of a print; None where it has none.

    Parameters
    ----------
    target : AnyTarget
    copy : int or None
        As of :func:`export_artwork`.

    Raises
    ------
    InputError
        The target states the scale of one print, or its description does not fit into a code.
    """
    if getattr(target, "print_scale", None) is not None:
        raise InputError(
            f"'{clipped(target.name)}' states the scale of one print of it, and what is printed is the "
            "design. Leave the key 'print_scale' out."
        )
    return None if copy is None or form_of(target) is None else code_text(target, copy)


def draw_sheet(axes: Axes, target: AnyTarget, sheet: Sheet, text: str | None) -> None:
    """Draw all that is on a sheet, with the text of its code if it has one, in the target's frame, mm."""
    _draw_board(axes, target, sheet)
    _draw_ruler(axes, sheet)
    _draw_captions(axes, sheet)
    if text is not None:
        _draw_code(axes, text, sheet)


@contextmanager
def own_style() -> Iterator[None]:
    """Draw as decided here; the user's own settings of matplotlib could change the scale."""
    with mpl.rc_context():
        mpl.rcdefaults()
        mpl.rcParams["svg.hashsalt"] = "labcal"  # else the ids, and so the bytes, differ from run to run
        mpl.rcParams["font.family"] = "DejaVu Sans"  # comes with matplotlib
        mpl.rcParams["pdf.fonttype"] = 42  # outlines that every printer takes
        yield


def _paper_size(sheet: Sheet, dpi: int | None) -> tuple[float, float]:
    """Return the paper's size, rounded up to whole pixels if there are any: that keeps the scale exact."""
    if dpi is None:
        return sheet.paper.width, sheet.paper.height
    pixel = MM_PER_INCH / dpi
    return math.ceil(sheet.paper.width / pixel) * pixel, math.ceil(sheet.paper.height / pixel) * pixel


def _resolution(sheet: Sheet, dpi: int | None) -> int:
    """Return the resolution to use, or refuse one that needs more than half of the memory."""
    wanted = DEFAULT_DPI if dpi is None else dpi
    if wanted < 1:
        raise InputError(f"The resolution is {wanted} dpi, but should be at least 1.")
    available = (memory_bytes() or _ASSUMED_MEMORY) / 2
    square_inches = sheet.paper.width * sheet.paper.height / MM_PER_INCH**2
    if square_inches * wanted**2 * _BYTES_PER_PIXEL > available:
        largest = math.floor(math.sqrt(available / (square_inches * _BYTES_PER_PIXEL)))
        size = f"{sheet.paper.width:.0f} mm x {sheet.paper.height:.0f} mm"
        raise InputError(
            f"A picture of {size} at {wanted} dpi does not fit into the memory of this machine. "
            f"Give at most `dpi={largest}`, or export SVG or PDF, which have no pixels."
        )
    return wanted


def _draw_board(axes: Axes, target: AnyTarget, sheet: Sheet) -> None:
    """Draw the print on its ground, and marks outside the board's corners to cut along."""
    board = sheet.board
    dots = "black"
    if target.is_white_on_black:
        dots = "white"
        ground = RectanglePatch(
            (board.x_min, board.y_min), board.width, board.height, facecolor="black", linewidth=0, snap=False
        )
        axes.add_patch(ground)
    axes.add_patch(PathPatch(printed_outlines(target), facecolor=dots, linewidth=0, snap=False, gid="dots"))
    near, far = 1.0, 4.0
    cut = sheet.cut
    for x, outward in ((cut.x_min, -1), (cut.x_max, 1)):
        for y, upward in ((cut.y_min, -1), (cut.y_max, 1)):
            _line(axes, (x + near * outward, x + far * outward), (y, y))
            _line(axes, (x, x), (y + near * upward, y + far * upward))


def _draw_ruler(axes: Axes, sheet: Sheet) -> None:
    """Draw a line every millimetre, longer ones with figures every ten."""
    left, top = sheet.ruler
    along, *across = ruler_marks(sheet)
    _line(axes, *along, gid="ruler")
    for mm, mark in enumerate(across):
        _line(axes, *mark)
        if mm % 10 == 0:
            label = f"{mm} mm" if mm == RULER_MM else str(mm)
            axes.text(left + mm, top - 5.0, label, fontsize=_points(2.2), ha="center", va="top")


def ruler_marks(sheet: Sheet) -> list[tuple[tuple[float, float], tuple[float, float]]]:
    """Return the lines of the ruler, x and y of both ends of each, mm: the one along it first."""
    left, top = sheet.ruler
    marks = [((left, left + RULER_MM), (top, top))]
    for mm in range(round(RULER_MM) + 1):
        length = 4.0 if mm % 10 == 0 else 3.0 if mm % 5 == 0 else 2.0
        marks.append(((left + mm, left + mm), (top, top - length)))
    return marks


def _draw_captions(axes: Axes, sheet: Sheet) -> None:
    for caption in sheet.captions:
        axes.text(caption.x, caption.y, caption.text, fontsize=_points(sheet.caption_mm), va="baseline")


def _draw_code(axes: Axes, text: str, sheet: Sheet) -> None:
    """Draw the cells of the code, those in a row as one, so that a viewer draws no hairlines between them."""
    place = sheet.code
    if place is None:
        return
    outlines = print_code(text).outlines(place.left, place.top, place.unit)
    axes.add_patch(PathPatch(outlines, facecolor="black", linewidth=0, snap=False, gid="code"))


def _line(axes: Axes, x: tuple[float, float], y: tuple[float, float], *, gid: str | None = None) -> None:
    """Draw a hairline that ends exactly at its ends and is not moved to whole pixels."""
    axes.add_patch(
        PathPatch(
            Outline(np.array([x, y]).T),
            fill=False,
            edgecolor="black",
            linewidth=_points(HAIRLINE_MM),
            capstyle="butt",
            snap=False,
            gid=gid,
        )
    )


def _points(mm: float) -> float:
    return mm / MM_PER_INCH * POINTS_PER_INCH
