"""Protocols of targets: numbered places on a flat board, and their print."""

from typing import Any, Protocol, runtime_checkable

from labcal.arrays import DotIndices, Lengths, Vectors3


@runtime_checkable
class Target(Protocol):
    """A flat board with places numbered (col, row): the dots of a grid, or the corners of a chessboard.

    The frame is the same for all: x right along columns, y up along rows, z out of the board, (0, 0) at the
    lower left and the origin. "Dot" stands for either kind wherever the two need not be distinguished.
    """

    @property
    def name(self) -> str:
        """Name of the target."""

    @property
    def description(self) -> str:
        """Description of the target, for people."""

    @property
    def cols(self) -> int:
        """Dots in a row."""

    @property
    def rows(self) -> int:
        """Rows of dots."""

    @property
    def count(self) -> int:
        """Number of dots."""

    @property
    def extent_mm(self) -> tuple[float, float, float, float]:
        """The board's edges ``(x_min, y_min, x_max, y_max)`` in the target's frame."""

    def indices(self) -> DotIndices:
        """Return (col, row) of every dot, row by row from (0, 0), shape (count, 2), integer."""

    def points(self, indices: DotIndices | None = None) -> Vectors3:
        """Return the places of dots, or of all, in the target's frame, mm, shape (n, 3), with z = 0."""

    def outer_diameters_mm(self) -> Lengths:
        """Return every dot's outer diameter in mm, in the order of :meth:`indices`; 0 for a corner.

        Where it is 0, the centre of the image is the image of the centre, and there is no eccentricity.
        """

    def symmetric_indices(self, indices: DotIndices) -> tuple[DotIndices, ...]:
        """Return (col, row) of dots under every turn after which the target looks the same; often nothing."""


@runtime_checkable
class PrintableTarget(Target, Protocol):
    """A target as its description in a file: its print, beside the places of its dots."""

    @property
    def margin_mm(self) -> float:
        """Bare board around what is printed."""

    @property
    def least_margin_mm(self) -> float:
        """Least margin with which the outermost dots are not cut."""

    @property
    def place_name(self) -> str:
        """Name of one of its places: a dot, or a corner."""

    @property
    def is_white_on_black(self) -> bool:
        """True if the print is lighter than the board."""

    @property
    def captions(self) -> tuple[str, str]:
        """Description and size: the text beside the print."""

    @property
    def sizes(self) -> tuple[str, str]:
        """Its pitch and the size of a dot in mm, for a table."""

    def model_dump(self, *, mode: str = "python") -> dict[str, Any]:
        """Return the keys and values of the description, as every pydantic model does."""
