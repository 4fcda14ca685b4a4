"""The inked areas of a grid of dots on float32 arrays of Dr.Jit, by the nearest dot centre."""

from collections.abc import Callable
from dataclasses import dataclass

import drjit as dr
import numpy as np

from labcal.render.paper import Paper
from labcal.render.variant import Jit
from labcal.scene.print import TruePrint
from labcal.targets.grid import DotGrid, Layout, Polarity


@dataclass(frozen=True)
class Ink:
    """A print with positions in uv, from 0 to 1 along the edges of the board."""

    paper: Paper
    grid: DotGrid
    offset_x: Jit
    """Displacement of each dot along x in the design, mm; one float per entry."""
    offset_y: Jit

    @classmethod
    def of(cls, made: TruePrint, grid: DotGrid, floats: Callable[[np.ndarray], Jit]) -> "Ink":
        """Return the ink of a print of a grid; `floats` makes an array of the variant."""
        offsets = (made.dot_offsets() / made.scale_x_y).astype(np.float32)
        return cls(Paper(made), grid, floats(offsets[:, 0].copy()), floats(offsets[:, 1].copy()))

    def is_dark(self, uv: Jit) -> Jit:
        """Return a mask of positions at which the print has the darker of its two colours."""
        target = self.grid
        x, y = self.paper.designed(uv)
        col, row, shift = self._nearest(x, y)
        dx, dy = x - shift - col * target.pitch_x_mm, y - row * target.pitch_y_mm
        if self.paper.made.is_displaced:
            number = dr.uint32_array_t(x)(row * target.cols + col)
            dx -= dr.gather(type(x), self.offset_x, number)
            dy -= dr.gather(type(x), self.offset_y, number)
        r2 = dx * dx + dy * dy
        ring = dr.mask_t(x)(False)
        for ring_col, ring_row in target.ring_indices:
            ring |= (col == ring_col) & (row == ring_row)
        outer = dr.select(ring, target.ring_outer_diameter_mm or 0.0, target.dot_diameter_mm)
        inner = dr.select(ring, target.ring_inner_diameter_mm or 0.0, 0.0)
        inked = (4.0 * r2 <= outer * outer) & (4.0 * r2 >= inner * inner)
        return inked if target.polarity is Polarity.BLACK_ON_WHITE else ~inked

    def _nearest(self, x: Jit, y: Jit) -> tuple[Jit, Jit, Jit]:
        """Return column and row of the nearest dot in the design, and the shift of its row in mm."""
        target = self.grid
        if target.layout is Layout.SYMMETRIC:
            col = dr.clip(dr.round(x / target.pitch_x_mm), 0, target.cols - 1)
            row = dr.clip(dr.round(y / target.pitch_y_mm), 0, target.rows - 1)
            return col, row, 0.0
        # The dots' square grid stands on its corner: steps to the upper right and to the upper left.
        across, up = x / target.pitch_x_mm, 0.5 * y / target.pitch_y_mm
        right, left = dr.round(up + across), dr.round(up - across)
        row = dr.clip(right + left, 0, target.rows - 1)
        odd = row - 2.0 * dr.floor(0.5 * row)
        col = dr.clip(0.5 * (right - left - odd), 0, target.cols - 1)
        return dr.round(col), row, 0.5 * target.pitch_x_mm * odd
