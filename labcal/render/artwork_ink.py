"""The inked areas of a print on float32 arrays of Dr.Jit, by distances from its edges."""

from collections.abc import Callable
from dataclasses import dataclass

import drjit as dr
import numpy as np

from labcal.render.paper import Paper
from labcal.render.variant import Jit
from labcal.scene.print import TruePrint
from labcal.targets.ink_distance import InkDistance, ink_distance
from labcal.targets.print_scale import as_designed


@dataclass(frozen=True)
class ArtworkInk:
    """A print by the outlines of its target's kind."""

    paper: Paper
    field: InkDistance
    distance: Jit
    """Of all points of the grid, row by row, mm."""

    @classmethod
    def of(cls, made: TruePrint, floats: Callable[[np.ndarray], Jit]) -> "ArtworkInk":
        """Return the ink of a print; `floats` makes an array of the variant."""
        return cls.of_field(made, ink_distance(as_designed(made.target)), floats)

    @classmethod
    def of_field(
        cls, made: TruePrint, field: InkDistance, floats: Callable[[np.ndarray], Jit]
    ) -> "ArtworkInk":
        """Return the ink of distances on a print."""
        return cls(Paper(made), field, floats(field.distance.ravel()))

    def is_dark(self, uv: Jit) -> Jit:
        """Return a mask of positions at which the print has the darker of its two colours."""
        inked = self.is_inked(uv)
        return ~inked if self.paper.made.target.is_white_on_black else inked

    def is_inked(self, uv: Jit) -> Jit:
        """Return a mask of positions inside the outlines."""
        (x_min, y_min), step, (rows, cols) = self.field.origin, self.field.step_mm, self.field.distance.shape
        x, y = self.paper.designed(uv)
        x, y = (x - x_min) / step, (y - y_min) / step
        inside = (x >= 0) & (x < cols - 1) & (y >= 0) & (y < rows - 1)
        col, row = dr.floor(dr.clip(x, 0, cols - 2)), dr.floor(dr.clip(y, 0, rows - 2))
        along, up = x - col, y - row
        number = dr.uint32_array_t(x)(row) * cols + dr.uint32_array_t(x)(col)

        def at(offset: int) -> Jit:
            return dr.gather(type(x), self.distance, number + offset, inside)

        low, high = dr.lerp(at(0), at(1), along), dr.lerp(at(cols), at(cols + 1), along)
        return inside & (dr.lerp(low, high, up) > 0.0)
