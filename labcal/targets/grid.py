"""The dot grid: places and sizes of the dots, and the rings among them, if any."""

import math
from enum import StrEnum
from typing import Annotated

import numpy as np
from pydantic import BaseModel, ConfigDict, Field, model_validator

from labcal.arrays import DotIndices, Lengths, Mask, Vectors3
from labcal.bounds import LEAST_SHARE_OF_PITCH, MOST_DOTS, Length, Margin
from labcal.run.names import Name
from labcal.targets.scaled_print import ScaledPrint

_FEWEST_SHIFTED_ROWS = 3
"""Of an asymmetric grid: in fewer no dot has neighbours on all four sides."""
GridIndex = tuple[Annotated[int, Field(ge=0)], Annotated[int, Field(ge=0)]]


class Polarity(StrEnum):
    """Polarity of the print: dark dots on a light board or the reverse."""

    BLACK_ON_WHITE = "black-on-white"
    WHITE_ON_BLACK = "white-on-black"


class Layout(StrEnum):
    """Arrangement of the rows."""

    SYMMETRIC = "symmetric"
    """Column above column."""
    ASYMMETRIC = "asymmetric"
    """Every row with an odd number is shifted right by half a pitch, as in OpenCV's asymmetric grids."""


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


class DotGrid(ScaledPrint):
    """A flat target with a grid of dots, three of them rings, or none.

    Dots are numbered (col, row) from 0, x to the right, y up, z out of the board; the centre of dot
    (0, 0) is the origin of the target's frame. Lengths are in millimetres.

    In an asymmetric grid `pitch_x_mm` is from dot to dot of a row, and `pitch_y_mm`, from row to row, is half
    of it, so that the dots also form a square grid that stands on its corner. With OpenCV's spacing s these
    are 2 s and s.
    """

    model_config = ConfigDict(frozen=True, extra="forbid")

    name: Name
    """Name of the target: letters, digits and hyphens."""
    description: str = ""
    """Description of the target, for people."""
    layout: Layout = Layout.SYMMETRIC
    """Arrangement of the rows: odd ones may be shifted by half a pitch."""
    cols: Annotated[int, Field(ge=2, le=1000)]
    """Dots in a row."""
    rows: Annotated[int, Field(ge=2, le=1000)]
    """Rows of dots."""
    pitch_x_mm: Length
    """Distance from dot to dot in a row."""
    pitch_y_mm: Length
    """Distance from row to row."""
    dot_diameter_mm: Length
    """Diameter of a full dot."""
    ring_outer_diameter_mm: Length | None = None
    """Outer diameter of a ring."""
    ring_inner_diameter_mm: Length | None = None
    """Diameter of the hole of a ring."""
    polarity: Polarity = Polarity.BLACK_ON_WHITE
    """Polarity: dots are dark on a light board or light on a dark one."""
    rings: Rings | None
    """None, which has to be stated, if all dots are alike."""
    margin_mm: Margin = 0.0
    """Bare board around the centres of the outermost dots."""

    @model_validator(mode="after")
    def _fits_together(self) -> "DotGrid":
        self._check_rings()
        if self.layout is Layout.ASYMMETRIC and self.rows < _FEWEST_SHIFTED_ROWS:
            raise ValueError(
                f"an asymmetric grid of {self.rows} rows is not found in pictures: give it "
                f"{_FEWEST_SHIFTED_ROWS} rows or more"
            )
        if self.layout is Layout.ASYMMETRIC and not math.isclose(self.pitch_x_mm, 2.0 * self.pitch_y_mm):
            raise ValueError(
                "the rows of an asymmetric grid are half a pitch_x_mm apart: pitch_y_mm should be "
                f"{self.pitch_x_mm / 2.0:g}"
            )
        if self.largest_diameter_mm >= min(self.cell_mm):
            raise ValueError("dots and rings must be smaller than the pitch, or they touch")
        least = LEAST_SHARE_OF_PITCH * max(self.cell_mm)
        if min(self.dot_diameter_mm, self.ring_inner_diameter_mm or math.inf) < least:
            raise ValueError(
                f"dots, and the holes of rings, must be at least {least:.3g} mm wide: a share of the pitch"
            )
        if self.count > MOST_DOTS:
            raise ValueError(f"a target has at most {MOST_DOTS} dots, but this one {self.count}")
        return self

    def _check_rings(self) -> None:
        """Raise where the rings and their diameters do not belong together."""
        outer, inner = self.ring_outer_diameter_mm, self.ring_inner_diameter_mm
        if self.rings is None:
            if outer is not None or inner is not None:
                raise ValueError(
                    "ring_outer_diameter_mm and ring_inner_diameter_mm mean nothing without rings: leave "
                    "them out, or state where the rings are"
                )
            return
        if self.layout is Layout.ASYMMETRIC:
            raise ValueError("an asymmetric grid has no rings: set rings to null")
        if outer is None or inner is None:
            raise ValueError("rings need ring_outer_diameter_mm and ring_inner_diameter_mm")
        if inner >= outer:
            raise ValueError("ring_inner_diameter_mm must be smaller than ring_outer_diameter_mm")
        for ring in (self.rings.origin, self.rings.x, self.rings.y):
            if ring[0] >= self.cols or ring[1] >= self.rows:
                raise ValueError(f"the ring at {ring} lies outside the {self.cols} x {self.rows} grid")

    @property
    def count(self) -> int:
        """Number of dots, rings included."""
        return self.cols * self.rows

    @property
    def largest_diameter_mm(self) -> float:
        """Diameter of the largest dot or ring."""
        return max(self.dot_diameter_mm, self.ring_outer_diameter_mm or 0.0)

    @property
    def least_margin_mm(self) -> float:
        """Half a radius of the largest dot around the outermost dots."""
        return 0.75 * self.largest_diameter_mm

    @property
    def place_name(self) -> str:
        """A dot."""
        return "dot"

    @property
    def is_white_on_black(self) -> bool:
        """True if dots are lighter than the board."""
        return self.polarity is Polarity.WHITE_ON_BLACK

    @property
    def captions(self) -> tuple[str, str]:
        """Dots and polarity; pitch and diameter."""
        dots = "dots in shifted rows" if self.layout is Layout.ASYMMETRIC else "dots"
        pitch = f"{self.pitch_x_mm:.6g} mm x {self.pitch_y_mm:.6g} mm"
        return (
            f"{self.name}: {self.cols} x {self.rows} {dots}, {self.polarity}",
            f"pitch {pitch}, dots {self.dot_diameter_mm:.6g} mm",
        )

    @property
    def sizes(self) -> tuple[str, str]:
        """Pitches and diameter."""
        return f"{self.pitch_x_mm:.6g} x {self.pitch_y_mm:.6g}", f"{self.dot_diameter_mm:g}"

    @property
    def ring_size(self) -> float:
        """Diameter of the rings over that of the dots; 1 where there are no rings."""
        return (self.ring_outer_diameter_mm or self.dot_diameter_mm) / self.dot_diameter_mm

    @property
    def hole_share(self) -> float:
        """Diameter of the rings' holes over that of the rings; a half where there are no rings."""
        if self.ring_outer_diameter_mm is None or self.ring_inner_diameter_mm is None:
            return 0.5
        return self.ring_inner_diameter_mm / self.ring_outer_diameter_mm

    @property
    def cell_mm(self) -> tuple[float, float]:
        """The steps between nearest dots, square to each other; diagonal in an asymmetric grid."""
        if self.layout is Layout.ASYMMETRIC:
            return (math.sqrt(2.0) * self.pitch_y_mm, math.sqrt(2.0) * self.pitch_y_mm)
        return (self.pitch_x_mm, self.pitch_y_mm)

    @property
    def extent_mm(self) -> tuple[float, float, float, float]:
        """The board's edges ``(x_min, y_min, x_max, y_max)`` in the target's frame."""
        x = (self.cols - 1) * self.pitch_x_mm + self._row_shift_mm + self.margin_mm
        y = (self.rows - 1) * self.pitch_y_mm + self.margin_mm
        x_scale, y_scale = self.scale_x_y.tolist()
        return (-self.margin_mm * x_scale, -self.margin_mm * y_scale, x * x_scale, y * y_scale)

    @property
    def _row_shift_mm(self) -> float:
        """Shift of rows with an odd number to the right."""
        return 0.5 * self.pitch_x_mm if self.layout is Layout.ASYMMETRIC else 0.0

    @property
    def ring_indices(self) -> tuple[GridIndex, ...]:
        """The (col, row) of the origin, x and y rings; none where all dots are alike."""
        return () if self.rings is None else (self.rings.origin, self.rings.x, self.rings.y)

    @property
    def key_indices(self) -> tuple[GridIndex, ...]:
        """The (col, row) of the dots that must be seen to number the others: the rings, else all dots."""
        return self.ring_indices or tuple((col, row) for row in range(self.rows) for col in range(self.cols))

    def holds(self, col: int, row: int) -> bool:
        """Return whether the declared grid has a dot of this index."""
        return 0 <= col < self.cols and 0 <= row < self.rows

    def holds_each(self, indices: DotIndices) -> Mask:
        """Return whether the declared grid has dots of these indices, shape (n, 2)."""
        return np.asarray(((indices >= 0) & (indices < [self.cols, self.rows])).all(axis=1))

    def indices(self) -> DotIndices:
        """Return (col, row) of every dot, row by row from dot (0, 0), shape (count, 2), integer."""
        row, col = np.divmod(np.arange(self.count), self.cols)
        return np.stack([col, row], axis=-1)

    def points(self, indices: DotIndices | None = None) -> Vectors3:
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
        places = np.zeros((len(wanted), 3))
        places[:, :2] = wanted * np.array([self.pitch_x_mm, self.pitch_y_mm])
        places[:, 0] += self._row_shift_mm * (wanted[:, 1] % 2)
        places[:, :2] *= self.scale_x_y
        return places

    def outer_diameters_mm(self) -> Lengths:
        """Return the diameter in mm of every dot's outer outline, in the order of :meth:`indices`."""
        diameters = np.full(self.count, self.dot_diameter_mm)
        for col, row in self.ring_indices:
            diameters[row * self.cols + col] = self.ring_outer_diameter_mm
        return np.asarray(diameters * self.mean_scale)

    def symmetric_indices(self, indices: DotIndices) -> tuple[DotIndices, ...]:
        """Return (col, row) of dots under every turn after which the whole target looks the same.

        With rings it never does. All dots alike, a symmetric grid looks the same after half a turn, and a
        square one after a quarter. An asymmetric one does after half a turn where it has an even number of
        rows; with an odd number the first and the last row are both unshifted, and half a turn would shift
        both, so that the two orientations differ. No quarter turn maps it to itself: of a square that holds
        it, one diagonal ends on dots and the other does not.

        Parameters
        ----------
        indices : ndarray of int, shape (n, 2)
            (col, row), also beyond the grid.

        Returns
        -------
        tuple of ndarray
            Nothing, one array, or three; each (n, 2).
        """
        if self.rings is not None or (self.layout is Layout.ASYMMETRIC and self.rows % 2 == 1):
            return ()
        last = np.array([self.cols - 1, self.rows - 1])
        half = last - indices
        is_square = self.cols == self.rows and math.isclose(self.pitch_x_mm, self.pitch_y_mm)
        if self.layout is Layout.ASYMMETRIC or not is_square:
            return (half,)
        quarter = np.stack([last[1] - indices[:, 1], indices[:, 0]], axis=-1)
        return (quarter, half, last - quarter)
