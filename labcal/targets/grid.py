"""The dot grid: where the dots are, how large, and which three of them are rings."""

from enum import StrEnum
from typing import Annotated

import numpy as np
from pydantic import BaseModel, ConfigDict, Field, model_validator

from labcal.arrays import DotIndices, Lengths, Points
from labcal.run.names import Name

Length = Annotated[float, Field(gt=0, allow_inf_nan=False)]
GridIndex = tuple[Annotated[int, Field(ge=0)], Annotated[int, Field(ge=0)]]


class Polarity(StrEnum):
    """Which is darker, the dots or the board."""

    BLACK_ON_WHITE = "black-on-white"
    WHITE_ON_BLACK = "white-on-black"


class Rings(BaseModel):
    """The (col, row) of the three ring markers that fix the orientation.

    `x` lies in the row of `origin` further along x, `y` in its column further along y.
    """

    model_config = ConfigDict(frozen=True, extra="forbid")

    origin: GridIndex
    x: GridIndex
    y: GridIndex

    @model_validator(mode="after")
    def _form_an_l(self) -> "Rings":
        if self.x[1] != self.origin[1] or self.x[0] <= self.origin[0]:
            raise ValueError("the x ring must lie in the row of the origin ring, further along x")
        if self.y[0] != self.origin[0] or self.y[1] <= self.origin[1]:
            raise ValueError("the y ring must lie in the column of the origin ring, further along y")
        return self

    @property
    def x_steps(self) -> int:
        """Grid steps from the origin ring to the x ring."""
        return self.x[0] - self.origin[0]

    @property
    def y_steps(self) -> int:
        """Grid steps from the origin ring to the y ring."""
        return self.y[1] - self.origin[1]


class DotGrid(BaseModel):
    """A flat target with a rectangular grid of dots, three of them rings.

    Dots are numbered (col, row) from 0, x to the right, y up, z out of the board; the centre of dot
    (0, 0) is the origin of the target's frame. Lengths are in millimetres.
    """

    model_config = ConfigDict(frozen=True, extra="forbid")

    name: Name
    description: str = ""
    cols: Annotated[int, Field(ge=2, le=1000)]
    rows: Annotated[int, Field(ge=2, le=1000)]
    pitch_x_mm: Length
    pitch_y_mm: Length
    dot_diameter_mm: Length
    ring_outer_diameter_mm: Length
    ring_inner_diameter_mm: Length
    polarity: Polarity = Polarity.BLACK_ON_WHITE
    rings: Rings
    margin_mm: Annotated[float, Field(ge=0, allow_inf_nan=False)] = 0.0
    """Bare board around the centres of the outermost dots."""

    @model_validator(mode="after")
    def _fits_together(self) -> "DotGrid":
        if self.ring_inner_diameter_mm >= self.ring_outer_diameter_mm:
            raise ValueError("ring_inner_diameter_mm must be smaller than ring_outer_diameter_mm")
        if max(self.dot_diameter_mm, self.ring_outer_diameter_mm) >= min(self.pitch_x_mm, self.pitch_y_mm):
            raise ValueError("dots and rings must be smaller than the pitch, or they touch")
        for ring in (self.rings.origin, self.rings.x, self.rings.y):
            if ring[0] >= self.cols or ring[1] >= self.rows:
                raise ValueError(f"the ring at {ring} lies outside the {self.cols} x {self.rows} grid")
        return self

    @property
    def count(self) -> int:
        """Number of dots, rings included."""
        return self.cols * self.rows

    @property
    def extent_mm(self) -> tuple[float, float, float, float]:
        """The board's edges ``(x_min, y_min, x_max, y_max)`` in the target's frame."""
        x = (self.cols - 1) * self.pitch_x_mm + self.margin_mm
        y = (self.rows - 1) * self.pitch_y_mm + self.margin_mm
        return (-self.margin_mm, -self.margin_mm, x, y)

    @property
    def ring_indices(self) -> tuple[GridIndex, GridIndex, GridIndex]:
        """The (col, row) of the origin, x and y rings."""
        return (self.rings.origin, self.rings.x, self.rings.y)

    def holds(self, col: int, row: int) -> bool:
        """Tell whether the declared grid has a dot of this index."""
        return 0 <= col < self.cols and 0 <= row < self.rows

    def indices(self) -> DotIndices:
        """Return (col, row) of every dot, row by row from dot (0, 0), shape (count, 2), integer."""
        row, col = np.divmod(np.arange(self.count), self.cols)
        return np.stack([col, row], axis=-1)

    def points(self, indices: DotIndices | None = None) -> Points:
        """Return the centres of dots in the target's frame.

        Parameters
        ----------
        indices : ndarray of int, shape (n, 2), optional
            (col, row) of the dots wanted, also beyond the grid; all dots where left out.

        Returns
        -------
        ndarray, shape (n, 3)
            Millimetres, with z = 0.
        """
        wanted = self.indices() if indices is None else indices
        pitch = np.array([self.pitch_x_mm, self.pitch_y_mm])
        return np.concatenate([wanted * pitch, np.zeros((len(wanted), 1))], axis=-1)

    def outer_diameters_mm(self) -> Lengths:
        """Return the diameter in mm of every dot's outer outline, in the order of :meth:`indices`."""
        diameters = np.full(self.count, self.dot_diameter_mm)
        for col, row in self.ring_indices:
            diameters[row * self.cols + col] = self.ring_outer_diameter_mm
        return diameters
