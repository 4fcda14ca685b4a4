"""The AprilGrid: AprilTags in a grid as Kalibr prints them, whose corners are measured."""

from typing import Annotated, Literal

import numpy as np
from pydantic import ConfigDict, Field, model_validator

from labcal.arrays import DotIndices, Lengths, Vectors3
from labcal.bounds import MOST_DOTS, Length, Margin
from labcal.run.names import Name
from labcal.targets.charuco import MarkerDictionary
from labcal.targets.corner_board import CornerBoard

Tags = Annotated[int, Field(ge=1, le=100)]


class AprilGrid(CornerBoard):
    """A flat target with the four corners of every tag of a grid, in Kalibr's convention.

    Between the corners of tags are small black squares, so that four of them meet at each corner, two black.
    Tags of prints that have none (`corner_squares`) lie alone on white.

    Corners are numbered (col, row) from 0, x to the right, y up, z out of the board: columns 0 and 1 are the
    left and the right corners of the first column of tags, 2 and 3 those of the second one. Corner (0, 0),
    the lower left one of the lower left tag, is the origin of the target's frame. Lengths are in millimetres.
    """

    model_config = ConfigDict(frozen=True, extra="forbid")

    kind: Literal["aprilgrid"]
    """Kind of the target."""
    name: Name
    """Name of the target: letters, digits and hyphens."""
    description: str = ""
    """Description of the target, for people."""
    tag_cols: Tags
    """Tags in a row: Kalibr's `tagCols`."""
    tag_rows: Tags
    """Rows of tags: Kalibr's `tagRows`."""
    tag_mm: Length
    """Side of a tag, its black border included: Kalibr's `tagSize`, which is in metres."""
    tag_spacing: Annotated[float, Field(ge=0.1, le=1.0)]
    """Space between tags over the side of a tag: Kalibr's `tagSpacing`."""
    dictionary: MarkerDictionary = MarkerDictionary.DICT_APRILTAG_36H11
    """OpenCV's name of the set of tags: Kalibr's t36h11 where left out."""
    first_id: Annotated[int, Field(ge=0, lt=10_000)] = 0
    """Id of the lower left tag; the others count on to the right, then upwards."""
    border_cells: Annotated[int, Field(ge=1, le=2)] = 2
    """Width of a tag's black border in cells: 2 on Kalibr's prints, 1 on most others."""
    corner_squares: bool = True
    """Small black squares touch the tags at their corners, as on Kalibr's prints; false for tags alone on
    white, whose corners are less exact."""
    margin_mm: Margin = 0.0
    """Bare board around what is printed."""

    @model_validator(mode="after")
    def _fits_together(self) -> "AprilGrid":
        if self.tag_count < 2:  # noqa: PLR2004 -- two that agree place the board
            raise ValueError("tag_cols and tag_rows: a board has at least two tags")
        if self.count > MOST_DOTS:
            raise ValueError(f"a target has at most {MOST_DOTS} corners, but this one {self.count}")
        if self.first_id + self.tag_count > self.dictionary.size:
            raise ValueError(
                f"the board has tags {self.first_id} to {self.first_id + self.tag_count - 1}, but "
                f"{self.dictionary} ends at {self.dictionary.size - 1}: lower first_id, or the numbers of "
                "tags"
            )
        return self

    @property
    def tag_count(self) -> int:
        """Number of tags."""
        return self.tag_cols * self.tag_rows

    @property
    def cols(self) -> int:
        """Corners in a row: two of every tag."""
        return 2 * self.tag_cols

    @property
    def rows(self) -> int:
        """Rows of corners: two of every tag."""
        return 2 * self.tag_rows

    @property
    def count(self) -> int:
        """Number of corners."""
        return self.cols * self.rows

    @property
    def gap_mm(self) -> float:
        """Space between tags, the side of the small squares."""
        return self.tag_spacing * self.tag_mm

    @property
    def extent_mm(self) -> tuple[float, float, float, float]:
        """The board's edges ``(x_min, y_min, x_max, y_max)`` in the target's frame."""
        beyond = self.margin_mm + self.gap_mm
        pitch = self.tag_mm + self.gap_mm
        across, up = (count * pitch - self.gap_mm + beyond for count in (self.tag_cols, self.tag_rows))
        x_scale, y_scale = self.scale_x_y.tolist()
        return (-beyond * x_scale, -beyond * y_scale, across * x_scale, up * y_scale)

    @property
    def captions(self) -> tuple[str, str]:
        """Tags and their ids; sizes."""
        ids = f"{self.first_id} to {self.first_id + self.tag_count - 1}"
        return (
            f"{self.name}: {self.tag_cols} x {self.tag_rows} tags, {self.dictionary} {ids}",
            f"tags {self.tag_mm:.6g} mm, spacing {self.gap_mm:.6g} mm ({self.tag_spacing:.6g})",
        )

    @property
    def sizes(self) -> tuple[str, str]:
        """Distance from tag to tag; a corner has no size."""
        pitch = self.tag_mm + self.gap_mm
        return f"{pitch:.6g} x {pitch:.6g}", "corner"

    def indices(self) -> DotIndices:
        """Return (col, row) of every corner, row by row from corner (0, 0), shape (count, 2), integer."""
        row, col = np.divmod(np.arange(self.count), self.cols)
        return np.stack([col, row], axis=-1)

    def points(self, indices: DotIndices | None = None) -> Vectors3:
        """Return the places of corners (n, 2), or of all, in the target's frame, mm, shape (n, 3)."""
        wanted = self.indices() if indices is None else indices
        tag, side = np.divmod(wanted, 2)
        places = (tag * (1.0 + self.tag_spacing) + side) * self.tag_mm * self.scale_x_y
        return np.concatenate([places, np.zeros((len(wanted), 1))], axis=-1)

    def outer_diameters_mm(self) -> Lengths:
        """Return zeros: a corner has no extent, and its image no eccentricity."""
        return np.zeros(self.count)

    def symmetric_indices(self, indices: DotIndices) -> tuple[DotIndices, ...]:  # noqa: ARG002 -- as of every target
        """Return nothing: the tags distinguish every orientation from all others."""
        return ()
