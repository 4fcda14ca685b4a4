"""Targets on pages of a usual paper: one where the paper holds the sheet, else tiles to be joined."""

import io
from dataclasses import dataclass

from matplotlib.axes import Axes
from matplotlib.backends.backend_agg import FigureCanvasAgg
from matplotlib.backends.backend_pdf import PdfPages
from matplotlib.figure import Figure
from matplotlib.patches import PathPatch
from matplotlib.path import Path as Outline

from labcal.errors import InputError
from labcal.paths import AnyPath, as_path
from labcal.run.outputs import write_file
from labcal.run.overwriting import require_file_place
from labcal.targets.artwork import (
    MM_PER_INCH,
    POINTS_PER_INCH,
    artwork_output,
    draw_sheet,
    own_style,
    print_text,
)
from labcal.targets.catalogue import AnyTarget
from labcal.targets.paper import PRINTER_MARGIN_MM, Paper
from labcal.targets.sheet import Rectangle, Sheet, lay_out_print
from labcal.targets.tiles import LABEL_MM, OVERLAP_MM, Tile, Tiling, tiled

_LABEL_POINTS = 7.0
_CROSS_MM = 3.0
"""Half the length of a register mark's arms."""
_HAIRLINE_POINTS = 0.3


@dataclass(frozen=True)
class PageSettings:
    """The pages that a sheet is printed on."""

    paper: Paper
    counts: tuple[int, int] | None = None
    """Pages side by side and one above the other, at most; as few as possible where left out."""
    margin_mm: float = PRINTER_MARGIN_MM
    """Rim that the printer leaves bare."""


def export_pages(
    target: AnyTarget,
    path: AnyPath,
    pages: PageSettings,
    *,
    copy: int | None = 0,
    force: bool = False,
) -> Tiling:
    """Write a target as a PDF with pages of a paper, at exact scale.

    Pages of a sheet that is larger than the paper overlap by 10 mm. Each page shows lines to cut along
    between dots, and register marks on them outside the board.

    Parameters
    ----------
    target : AnyTarget
    path : str or os.PathLike
        The file, ending in ``.pdf``.
    pages : PageSettings
    copy : int or None
        As of :func:`labcal.targets.artwork.export_artwork`.
    force : bool
        Replace a file that labcal wrote.

    Raises
    ------
    InputError
        The name does not end in ``.pdf``, or the sheet does not fit into so many pages.
    OutputError
        The file exists or cannot be written.
    """
    path = as_path(path)
    output = artwork_output(path)
    if path.suffix.lower() != ".pdf":
        raise InputError(f"Pages of a paper are written as PDF, not as {path.name}: give a name in .pdf.")
    require_file_place(path, force=force)
    text, sheet = print_text(target, copy), lay_out_print(target, copy)
    tiling = tiled(target, sheet, pages.paper, pages.counts, pages.margin_mm)
    write_file(path, _drawn(_Print(target, sheet, text), tiling), kind=output.kind, force=force)
    return tiling


@dataclass(frozen=True)
class _Print:
    """A target laid out, with the text of its code if it has one."""

    target: AnyTarget
    sheet: Sheet
    text: str | None


def _drawn(laid: _Print, tiling: Tiling) -> bytes:
    """Return the PDF."""
    buffer = io.BytesIO()
    with own_style(), PdfPages(buffer, metadata={"CreationDate": None}) as pages:
        for number, tile in enumerate(tiling.tiles, 1):
            figure = _page(laid, tiling, tile, number)
            pages.savefig(figure)
    return buffer.getvalue()


def _page(laid: _Print, tiling: Tiling, tile: Tile, number: int) -> Figure:
    """Return a page: its part of the sheet in the middle, and below it a line that says which part it is."""
    width, height = tiling.page_mm
    figure = Figure(
        figsize=(width / MM_PER_INCH, height / MM_PER_INCH), dpi=POINTS_PER_INCH, facecolor="white"
    )
    FigureCanvasAgg(figure)
    window, many = tile.window, len(tiling.tiles) > 1
    lift = LABEL_MM if many else 0.0
    left = 0.5 * (width - window.width)
    low = tiling.margin_mm + lift + 0.5 * (height - 2.0 * tiling.margin_mm - lift - window.height)
    if not many:
        left = low = 0.0
    place = (left / width, low / height, window.width / width, window.height / height)
    axes = figure.add_axes(place)
    axes.set_axis_off()
    axes.set_xlim(window.x_min, window.x_max)
    axes.set_ylim(window.y_min, window.y_max)
    draw_sheet(axes, laid.target, laid.sheet, laid.text)
    for text in axes.texts:
        text.set_clip_on(True)
    if many:
        _draw_cuts(axes, laid.sheet.board, tiling, laid.sheet.paper)
        figure.text(
            0.5, (low - 0.6 * LABEL_MM) / height, _label(laid.target, tiling, tile, number),
            fontsize=_LABEL_POINTS, ha="center",
        )  # fmt: skip
    return figure


def _draw_cuts(axes: Axes, board: Rectangle, tiling: Tiling, whole: Rectangle) -> None:
    """Draw the lines to cut along, grey, and black register marks on them beside the board."""
    for x in tiling.cuts_x:
        _line(axes, (x, x), (whole.y_min, whole.y_max), "0.6")
        for y in (board.y_min - _CROSS_MM - 1.0, board.y_max + _CROSS_MM + 1.0):
            _cross(axes, x, y)
    for y in tiling.cuts_y:
        _line(axes, (whole.x_min, whole.x_max), (y, y), "0.6")
        for x in (board.x_min - _CROSS_MM - 1.0, board.x_max + _CROSS_MM + 1.0):
            _cross(axes, x, y)


def _cross(axes: Axes, x: float, y: float) -> None:
    _line(axes, (x - _CROSS_MM, x + _CROSS_MM), (y, y), "black")
    _line(axes, (x, x), (y - _CROSS_MM, y + _CROSS_MM), "black")


def _line(axes: Axes, x: tuple[float, float], y: tuple[float, float], colour: str) -> None:
    """Draw a hairline."""
    axes.add_patch(
        PathPatch(
            Outline([(x[0], y[0]), (x[1], y[1])]),
            fill=False,
            edgecolor=colour,
            linewidth=_HAIRLINE_POINTS,
            snap=False,
        )
    )


def _label(target: AnyTarget, tiling: Tiling, tile: Tile, number: int) -> str:
    """Return the line of text of a page."""
    across, up = tiling.counts
    return (
        f"{target.name}, page {number} of {len(tiling.tiles)}: column {tile.col + 1} of {across}, row "
        f"{up - tile.row} of {up} from the top. Pages overlap by {OVERLAP_MM:g} mm: cut one of two "
        "neighbours "
        "along the grey line, lay it on the other's."
    )
