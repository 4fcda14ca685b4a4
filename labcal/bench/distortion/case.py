"""Cells of a plan, and the cases that fill them: one for each seed."""

from collections.abc import Mapping
from dataclasses import dataclass, field
from enum import StrEnum

Setting = bool | int | float | str


class Layout(StrEnum):
    """The arrangement of training points."""

    PLANES = "planes"
    """Grids on four planes across the volume, its faces included."""
    VOLUME = "volume"
    """Random places in the volume."""


class Measured(StrEnum):
    """The region of the points on which a method is measured."""

    WITHIN = "within"
    """In the convex hull of the training points."""
    OUTSIDE = "outside"
    """Outside the hull, up to a margin of a quarter of the volume's sides."""


@dataclass(frozen=True)
class Cell:
    """A combination of all factors but the method, the region and the seed.

    Attributes
    ----------
    strength : float
        0 for a pinhole to 1.
    noise_px : float
        Standard deviation of each coordinate of a pixel, in training and in measuring.
    points : int
        Training points that are asked for.
    """

    family: str
    strength: float
    noise_px: float
    points: int
    layout: Layout

    @property
    def names(self) -> tuple[str, ...]:
        """The texts that name its random numbers and its files."""
        return (
            self.family,
            f"{self.strength:g}",
            f"{self.noise_px:g}",
            str(self.points),
            str(self.layout),
        )


@dataclass(frozen=True)
class Case:
    """A cell with one seed, and the methods that are measured on its data."""

    cell: Cell
    seed: int
    methods: tuple[str, ...]
    regions: tuple[Measured, ...]
    tests: int
    """Points to measure in each region."""
    settings: Mapping[str, Mapping[str, Setting]] = field(default_factory=dict)
    """Constructor arguments by method that differ from its defaults."""
    sources: tuple[str, ...] = ()
    """Digests of the files of methods of one's own: a case is measured anew where one has changed."""

    @property
    def key(self) -> str:
        """The name of the result file."""
        return "_".join((*self.cell.names, str(self.seed)))
