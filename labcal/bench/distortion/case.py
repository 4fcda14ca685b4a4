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


class Source(StrEnum):
    """The origin of the pixels."""

    SIMULATED = "simulated"
    """Projected points with normal noise."""
    RENDERED = "rendered"
    """Dots that are detected in rendered pictures."""
    DETECTIONS = "detections"
    """Detections of one's own, of a target on a stage."""


NO_FAULT = "none"
"""The name of what is wrong where nothing is."""


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
        Standard deviation of each coordinate of a pixel, in training and in measuring; 0 where the pixels are
        detected, since their noise is that of the pictures.
    points : int
        Training points that are asked for.
    source : Source
    fault : str
        The fault of the board or of the laboratory that the methods do not know of, or `NO_FAULT`.
    """

    family: str
    strength: float
    noise_px: float
    points: int
    layout: Layout
    source: Source = Source.SIMULATED
    fault: str = NO_FAULT

    @property
    def is_usual(self) -> bool:
        """True if its points are simulated and nothing is wrong: only such figures have limits."""
        return self.source is Source.SIMULATED and self.fault == NO_FAULT

    @property
    def is_pictured(self) -> bool:
        """True if its dots are detected in pictures and nothing is wrong."""
        return self.source is Source.RENDERED and self.fault == NO_FAULT

    @property
    def stated_noise_px(self) -> float:
        """The noise that is added to each coordinate, px; NaN where the sensor makes it."""
        return self.noise_px if self.source is Source.SIMULATED else float("nan")

    @property
    def names(self) -> tuple[str, ...]:
        """The texts that name its random numbers, which are the same with a fault and without."""
        return (
            self.family,
            f"{self.strength:g}",
            f"{self.noise_px:g}",
            str(self.points),
            str(self.layout),
        )


@dataclass(frozen=True)
class Pictures:
    """The pictures of a rendered case."""

    views: int
    """Heights of the board to train on; there is a test view between each two."""
    spp: int
    """Rays a pixel."""


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
    pictures: Pictures | None = None
    """The pictures in which the dots are detected; None of simulated pixels."""

    @property
    def key(self) -> str:
        """The name of the result file."""
        usual = ((str(self.cell.source), Source.SIMULATED), (self.cell.fault, NO_FAULT))
        special = [name for name, common in usual if name != common]
        return "_".join((*self.cell.names, *special, str(self.seed)))
