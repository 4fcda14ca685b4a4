"""The room that paper, picture and working volume leave for a board."""

from collections.abc import Callable
from dataclasses import dataclass

from labcal.errors import InputError
from labcal.guide.target_design.question import TargetQuestion
from labcal.guide.target_design.sight import Sight
from labcal.targets.catalogue import AnyTarget
from labcal.targets.grid import DotGrid
from labcal.targets.paper import sheet_size
from labcal.targets.sheet import lay_out_print
from labcal.targets.tiles import tiled, tiled_room

PICTURE_SHARE = 0.9
"""Share of the picture's sides, at the usual distance, beyond which a board is not larger."""


@dataclass(frozen=True)
class Room:
    """Largest width and height of a board, mm."""

    width_mm: float
    height_mm: float

    @property
    def longer_mm(self) -> float:
        """Longer side."""
        return max(self.width_mm, self.height_mm)


def rooms(question: TargetQuestion, sights: list[Sight]) -> tuple[Room, ...]:
    """Return the room for a board on paper held upright and across.

    Parameters
    ----------
    question : TargetQuestion
    sights : list of Sight
        Of its cameras.
    """
    beside, below = _around_board()
    sheets = (
        tiled_room(question.paper, question.tiles, question.printer_margin_mm)
        if question.tiles != (1, 1)
        else _one_sheet(question)
    )
    seen = [sight.width_mm(question.middle_mm) for sight in sights]
    most = (PICTURE_SHARE * min(w for w, _ in seen), PICTURE_SHARE * min(h for _, h in seen))
    limits = [most] if question.room_mm is None else [most, question.room_mm]
    found = []
    for sheet in sheets:
        width, height = sheet[0] - beside, sheet[1] - below
        for limit in limits:
            across = limit if width >= height else limit[::-1]
            width, height = min(width, across[0]), min(height, across[1])
        found.append(Room(width, height))
    return tuple(found)


def fits_paper(target: AnyTarget, question: TargetQuestion) -> bool:
    """Tell whether the sheet of a target can be printed on the paper, or on its tiles."""
    width, height = sheet_size(target)
    if question.tiles == (1, 1):
        grow = 2.0 * question.border_mm
        return question.paper.holds(width + grow, height + grow)
    try:
        tiled(target, lay_out_print(target), question.paper, question.tiles, question.printer_margin_mm)
    except InputError:
        return False
    return True


def largest(
    question: TargetQuestion, counts: tuple[int, int], made: Callable[[int, int], AnyTarget | None]
) -> AnyTarget | None:
    """Return the largest target of a form that can be printed; None where none can.

    Parameters
    ----------
    question : TargetQuestion
    counts : (int, int)
        Columns and rows to begin with.
    made : callable
        Takes columns and rows; returns the target, or None where so few are none.
    """
    cols, rows = counts
    while (target := made(cols, rows)) is not None:
        if fits_paper(target, question):
            return target
        width, height = sheet_size(target)
        across = _excess(question, width, height)
        if across:
            cols -= 1
        else:
            rows -= 1
    return None


def _around_board() -> tuple[float, float]:
    """Return how much wider and higher the sheet of a wide board is than the board, mm."""
    probe = DotGrid(
        name="probe", cols=2, rows=2, pitch_x_mm=200.0, pitch_y_mm=200.0, dot_diameter_mm=9.0, rings=None
    )
    laid = lay_out_print(probe)
    return laid.paper.width - laid.board.width, laid.paper.height - laid.board.height


def _one_sheet(question: TargetQuestion) -> tuple[tuple[float, float], tuple[float, float]]:
    """Return width and height of the paper, upright and across, without the bare rim."""
    off = 2.0 * question.border_mm
    width, height = question.paper.width_mm - off, question.paper.height_mm - off
    return (width, height), (height, width)


def _excess(question: TargetQuestion, width: float, height: float) -> bool:
    """Tell whether a sheet is too wide rather than too high."""
    sheets = (
        tiled_room(question.paper, question.tiles, question.printer_margin_mm)
        if question.tiles != (1, 1)
        else _one_sheet(question)
    )
    over = [(width - w, height - h) for w, h in sheets]
    nearest = min(over, key=lambda one: max(one[0], 0.0) + max(one[1], 0.0))
    return nearest[0] > nearest[1]
