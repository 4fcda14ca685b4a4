"""The ink of a print: of the bare target, or of its whole sheet with code, ruler and captions."""

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np

from labcal.render.artwork_ink import ArtworkInk
from labcal.render.ink import Ink
from labcal.render.paper import Paper
from labcal.render.variant import Jit
from labcal.scene.print import TruePrint
from labcal.targets.grid import DotGrid
from labcal.targets.ink_distance import MOST_STEPS, polygon_distance
from labcal.targets.print_scale import as_designed
from labcal.targets.printed_sheet import beside_target
from labcal.targets.sheet import Rectangle, lay_out_print


@dataclass(frozen=True)
class SheetInk:
    """The ink of a sheet as it is cut out."""

    target: Ink | ArtworkInk
    beside: ArtworkInk
    """Code, ruler and captions below the target, always dark on light."""
    board: Rectangle
    """The target's edges as designed, mm."""

    @property
    def paper(self) -> Paper:
        """The paper of the whole sheet."""
        return self.target.paper

    def is_dark(self, uv: Jit) -> Jit:
        """Return a mask of positions at which the print has the darker of its two colours."""
        x, y = self.paper.designed(uv)
        board = self.board
        on_board = (x > board.x_min) & (x < board.x_max) & (y > board.y_min) & (y < board.y_max)
        return (on_board & self.target.is_dark(uv)) | (~on_board & self.beside.is_inked(uv))


def ink_of(made: TruePrint, floats: Callable[[np.ndarray], Jit]) -> Ink | ArtworkInk | SheetInk:
    """Return the ink of a print.

    Parameters
    ----------
    made : TruePrint
    floats : callable
        Makes an array of the variant.

    Raises
    ------
    InputError
        A code is asked for, and the description does not fit into one.
    """
    grid = made.target
    target = Ink.of(made, grid, floats) if isinstance(grid, DotGrid) else ArtworkInk.of(made, floats)
    if made.number is None:
        return target
    sheet = lay_out_print(as_designed(grid), made.number)
    cut, board = sheet.cut, sheet.board
    below = Rectangle(cut.x_min, cut.y_min, cut.x_max, board.y_min)
    step = max(below.width, below.height) / MOST_STEPS
    field = polygon_distance(beside_target(grid, made.number), below, step)
    return SheetInk(target, ArtworkInk.of_field(made, field, floats), board)
