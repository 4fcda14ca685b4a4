"""The ChArUco board: a chessboard whose white squares carry markers, so that every corner is known."""

from enum import StrEnum
from typing import Annotated, Literal

import numpy as np
from jaxtyping import Bool, Int
from pydantic import ConfigDict, Field, model_validator

from labcal.arrays import DotIndices, Lengths, Vectors3
from labcal.bounds import LEAST_SHARE_OF_PITCH, Length, Margin
from labcal.run.names import Name
from labcal.targets.corner_board import CornerBoard

Squares = Annotated[int, Field(ge=3, le=200)]


class Pattern(StrEnum):
    """Place of the black squares of the chessboard; the two differ if the number of rows is even."""

    CURRENT = "current"
    """The upper left one, always: OpenCV from 4.6 on."""
    LEGACY = "legacy"
    """The lower left one: OpenCV before 4.6, and many a board that is sold."""


class MarkerDictionary(StrEnum):
    """OpenCV's sets of markers, by OpenCV's names."""

    DICT_4X4_50 = "DICT_4X4_50"
    DICT_4X4_100 = "DICT_4X4_100"
    DICT_4X4_250 = "DICT_4X4_250"
    DICT_4X4_1000 = "DICT_4X4_1000"
    DICT_5X5_50 = "DICT_5X5_50"
    DICT_5X5_100 = "DICT_5X5_100"
    DICT_5X5_250 = "DICT_5X5_250"
    DICT_5X5_1000 = "DICT_5X5_1000"
    DICT_6X6_50 = "DICT_6X6_50"
    DICT_6X6_100 = "DICT_6X6_100"
    DICT_6X6_250 = "DICT_6X6_250"
    DICT_6X6_1000 = "DICT_6X6_1000"
    DICT_7X7_50 = "DICT_7X7_50"
    DICT_7X7_100 = "DICT_7X7_100"
    DICT_7X7_250 = "DICT_7X7_250"
    DICT_7X7_1000 = "DICT_7X7_1000"
    DICT_ARUCO_ORIGINAL = "DICT_ARUCO_ORIGINAL"
    DICT_APRILTAG_16H5 = "DICT_APRILTAG_16h5"
    DICT_APRILTAG_25H9 = "DICT_APRILTAG_25h9"
    DICT_APRILTAG_36H10 = "DICT_APRILTAG_36h10"
    DICT_APRILTAG_36H11 = "DICT_APRILTAG_36h11"
    DICT_ARUCO_MIP_36H12 = "DICT_ARUCO_MIP_36h12"

    @property
    def size(self) -> int:
        """Number of markers in the set."""
        return _SIZES.get(self.value) or int(self.value.rpartition("_")[2])


_SIZES = {
    "DICT_ARUCO_ORIGINAL": 1024,
    "DICT_APRILTAG_16h5": 30,
    "DICT_APRILTAG_25h9": 35,
    "DICT_APRILTAG_36h10": 2320,
    "DICT_APRILTAG_36h11": 587,
    "DICT_ARUCO_MIP_36h12": 250,
}


class CharucoBoard(CornerBoard):
    """A flat target with the inner corners of a chessboard, numbered by the markers in its white squares.

    Corners are numbered (col, row) from 0, x to the right, y up, z out of the board; corner (0, 0), the lower
    left one, is the origin of the target's frame. Lengths are in millimetres. OpenCV counts the other way:
    see :meth:`from_opencv`.
    """

    model_config = ConfigDict(frozen=True, extra="forbid")

    kind: Literal["charuco"]
    """Kind of the target."""
    name: Name
    """Name of the target: letters, digits and hyphens."""
    description: str = ""
    """Description of the target, for people."""
    squares: tuple[Squares, Squares]
    """Squares along x and along y, one more than corners."""
    square_mm: Length
    """Side of a square of the chessboard."""
    marker_mm: Length
    """Side of a marker."""
    dictionary: MarkerDictionary
    """OpenCV's name of the dictionary of the markers."""
    first_id: Annotated[int, Field(ge=0, lt=10_000)] = 0
    """Id of the first marker, at the upper left; the others count on, row by row."""
    pattern: Pattern = Pattern.CURRENT
    """Place of the black squares if the number of rows of squares is even."""
    margin_mm: Margin = 0.0
    """Bare board around the chessboard."""

    @model_validator(mode="after")
    def _fits_together(self) -> "CharucoBoard":
        if self.marker_mm >= self.square_mm:
            raise ValueError("marker_mm must be smaller than square_mm, since markers lie in white squares")
        if self.marker_mm < LEAST_SHARE_OF_PITCH * self.square_mm:
            raise ValueError("marker_mm is next to nothing beside square_mm")
        if self.first_id + self.marker_count > self.dictionary.size:
            if self.marker_count <= self.dictionary.size:
                raise ValueError(
                    f"the board has markers {self.first_id} to {self.first_id + self.marker_count - 1}, but "
                    f"{self.dictionary} ends at {self.dictionary.size - 1}: lower first_id"
                )
            raise ValueError(
                f"{self.squares[0]} x {self.squares[1]} squares take {self.marker_count} markers, but "
                f"{self.dictionary} has {self.dictionary.size}: name a larger dictionary"
            )
        return self

    @property
    def cols(self) -> int:
        """Corners in a row."""
        return self.squares[0] - 1

    @property
    def rows(self) -> int:
        """Rows of corners."""
        return self.squares[1] - 1

    @property
    def count(self) -> int:
        """Number of corners."""
        return self.cols * self.rows

    @property
    def marker_count(self) -> int:
        """Number of markers, one in every white square."""
        across, up = self.squares
        return int((~self.is_black(*np.meshgrid(np.arange(across), np.arange(up)))).sum())

    @property
    def extent_mm(self) -> tuple[float, float, float, float]:
        """The board's edges ``(x_min, y_min, x_max, y_max)`` in the target's frame."""
        low = -self.square_mm - self.margin_mm
        across, up = ((count - 1) * self.square_mm + self.margin_mm for count in self.squares)
        x_scale, y_scale = self.scale_x_y.tolist()
        return (low * x_scale, low * y_scale, across * x_scale, up * y_scale)

    @property
    def captions(self) -> tuple[str, str]:
        """Squares, markers and pattern; sizes."""
        pattern = f"{self.dictionary}, {self.pattern} pattern"
        if self.first_id:
            pattern += f", markers from {self.first_id}"
        return (
            f"{self.name}: {self.squares[0]} x {self.squares[1]} squares, {pattern}",
            f"squares {self.square_mm:.6g} mm, markers {self.marker_mm:.6g} mm",
        )

    @property
    def sizes(self) -> tuple[str, str]:
        """Sides of a square; a corner has no size."""
        return f"{self.square_mm:.6g} x {self.square_mm:.6g}", "corner"

    @property
    def corner_gap(self) -> float:
        """White between a corner's edges and the nearest markers, in squares."""
        return 0.5 * (1.0 - self.marker_mm / self.square_mm)

    def clear_reach(self, col: int, row: int) -> float:  # noqa: ARG002 -- as of every board of squares
        """Return 1: black squares are plain."""
        return 1.0

    def is_black(self, i: Int[np.ndarray, "*n"], j: Int[np.ndarray, "*n"]) -> Bool[np.ndarray, "*n"]:
        """Return which squares are black, counted from 0 at the lower left; the others carry markers."""
        first = self.squares[1] - 1 if self.pattern is Pattern.CURRENT else 0
        return np.asarray((i + j + first) % 2 == 0)

    def indices(self) -> DotIndices:
        """Return (col, row) of every corner, row by row from corner (0, 0), shape (count, 2), integer."""
        row, col = np.divmod(np.arange(self.count), self.cols)
        return np.stack([col, row], axis=-1)

    def points(self, indices: DotIndices | None = None) -> Vectors3:
        """Return the places of corners in the target's frame.

        Parameters
        ----------
        indices : ndarray of int, shape (n, 2), optional
            (col, row) of the corners wanted; all where left out.

        Returns
        -------
        ndarray, shape (n, 3)
            Millimetres, with z = 0.
        """
        wanted = self.indices() if indices is None else indices
        places = wanted * self.square_mm * self.scale_x_y
        return np.concatenate([places, np.zeros((len(wanted), 1))], axis=-1)

    def outer_diameters_mm(self) -> Lengths:
        """Return zeros: a corner has no extent, and its image no eccentricity."""
        return np.zeros(self.count)

    def symmetric_indices(self, indices: DotIndices) -> tuple[DotIndices, ...]:  # noqa: ARG002 -- as of every target
        """Return nothing: the markers distinguish every orientation from all others."""
        return ()

    def from_opencv(self, ids: Int[np.ndarray, " n"]) -> DotIndices:
        """Return (col, row) of OpenCV's corner ids, shape (n, 2).

        OpenCV counts corners row by row from the upper left; its board has x right, y down and z into the
        board, with the origin at the upper left corner of the chessboard.
        """
        down, col = np.divmod(ids, self.cols)
        return np.stack([col, self.rows - 1 - down], axis=-1)

    def points_from_opencv(self, p: Vectors3) -> Vectors3:
        """Return points of OpenCV's board in the target's frame, mm."""
        origin = np.array([self.square_mm, self.rows * self.square_mm, 0.0])
        return np.asarray((p - origin) * np.array([1.0, -1.0, -1.0]))
