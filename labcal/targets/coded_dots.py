"""Coded dots: round dots, each with a ring of black and white sectors around it that names it."""

from typing import Annotated, Literal

import numpy as np
from pydantic import ConfigDict, Field, model_validator

from labcal.arrays import DotIndices, Lengths, Vectors3
from labcal.bounds import Length, Margin
from labcal.run.names import Name
from labcal.targets.ring_codes import RingCode
from labcal.targets.scaled_print import ScaledPrint

RING_INNER, RING_OUTER = 2.0, 3.0
"""Radii between which the code ring lies, in radii of the dot."""
QUIET = 4.0
"""Nothing is printed from the ring to here, in radii of the dot."""


class CodedDots(ScaledPrint):
    """A sheet of coded dots with numbers in a row, to be cut up, or to be measured as it is.

    Around each dot of radius r is white paper to 2 r, the code ring from 2 r to 3 r, and white paper to 4 r.
    The dot is what is measured; the ring names it. Dots are (col, row) from 0, x to the right, y up, z out
    of the sheet; the centre of dot (0, 0), the lower left one, is the origin. Lengths are in millimetres.
    """

    model_config = ConfigDict(frozen=True, extra="forbid")

    kind: Literal["coded-dots"]
    """Kind of the target."""
    name: Name
    """Name of the target: letters, digits and hyphens."""
    description: str = ""
    """Description of the target, for people."""
    code: RingCode
    """Code of the rings."""
    first_mark: Annotated[int, Field(ge=0)] = 0
    """Number of the mark of dot (0, 0); numbers go on along the rows."""
    cols: Annotated[int, Field(ge=1, le=1000)]
    """Dots in a row."""
    rows: Annotated[int, Field(ge=1, le=1000)]
    """Rows of dots."""
    pitch_mm: Length
    """Distance of neighbouring dots, along rows and columns."""
    dot_diameter_mm: Length
    """Diameter of a dot; that of its whole mark is four times as large."""
    margin_mm: Margin = 0.0
    """Bare paper around the centres of the outermost dots."""

    @model_validator(mode="after")
    def _fits_together(self) -> "CodedDots":
        if self.pitch_mm < QUIET * self.dot_diameter_mm:
            raise ValueError(
                f"pitch_mm must be at least {QUIET:g} times dot_diameter_mm, the diameter of a whole mark"
            )
        if self.first_mark + self.count > self.code.size:
            raise ValueError(
                f"{self.cols} x {self.rows} dots from mark {self.first_mark} on end at "
                f"{self.first_mark + self.count - 1}, but '{self.code}' has {self.code.size} marks from 0 on"
            )
        return self

    @property
    def count(self) -> int:
        """Number of dots."""
        return self.cols * self.rows

    @property
    def least_margin_mm(self) -> float:
        """The radius of a whole mark."""
        return 0.5 * QUIET * self.dot_diameter_mm

    @property
    def place_name(self) -> str:
        """A dot."""
        return "dot"

    @property
    def is_white_on_black(self) -> bool:
        """False: dots and sectors are printed black."""
        return False

    @property
    def captions(self) -> tuple[str, str]:
        """Code and numbers; sizes."""
        last = self.first_mark + self.count - 1
        return (
            f"{self.name}: coded dots '{self.code}', {self.first_mark} to {last}",
            f"pitch {self.pitch_mm:.6g} mm, dots {self.dot_diameter_mm:.6g} mm",
        )

    @property
    def sizes(self) -> tuple[str, str]:
        """Pitches and diameter."""
        return f"{self.pitch_mm:.6g} x {self.pitch_mm:.6g}", f"{self.dot_diameter_mm:g}"

    @property
    def extent_mm(self) -> tuple[float, float, float, float]:
        """The sheet's edges ``(x_min, y_min, x_max, y_max)`` in the target's frame."""
        across, up = ((n - 1) * self.pitch_mm + self.margin_mm for n in (self.cols, self.rows))
        x_scale, y_scale = self.scale_x_y.tolist()
        return (-self.margin_mm * x_scale, -self.margin_mm * y_scale, across * x_scale, up * y_scale)

    def indices(self) -> DotIndices:
        """Return (col, row) of every dot, row by row from dot (0, 0), shape (count, 2), integer."""
        row, col = np.divmod(np.arange(self.count), self.cols)
        return np.stack([col, row], axis=-1)

    def marks(self, indices: DotIndices | None = None) -> np.ndarray:
        """Return the numbers of the marks of dots (n, 2), or of all, shape (n,), integer."""
        wanted = self.indices() if indices is None else indices
        return np.asarray(self.first_mark + wanted[:, 1] * self.cols + wanted[:, 0])

    def points(self, indices: DotIndices | None = None) -> Vectors3:
        """Return the centres of dots in the target's frame, mm, shape (n, 3), with z = 0."""
        wanted = self.indices() if indices is None else indices
        places = wanted * self.pitch_mm * self.scale_x_y
        return np.concatenate([places, np.zeros((len(wanted), 1))], axis=-1)

    def outer_diameters_mm(self) -> Lengths:
        """Return the diameter in mm of every dot, in the order of :meth:`indices`; rings do not count."""
        return np.full(self.count, self.dot_diameter_mm * self.mean_scale)

    def symmetric_indices(self, indices: DotIndices) -> tuple[DotIndices, ...]:  # noqa: ARG002 -- as of every target
        """Return nothing: every dot has a name."""
        return ()
