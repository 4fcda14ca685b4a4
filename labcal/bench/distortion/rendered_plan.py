"""The section `rendered` of a plan: the cases that are measured through pictures."""

from collections.abc import Iterator
from dataclasses import replace
from itertools import product
from statistics import median_high
from typing import Annotated

from pydantic import AfterValidator, BaseModel, ConfigDict, Field

from labcal.bench.distortion.case import Case, Cell, Layout, Measured, Pictures, Source
from labcal.bench.distortion.factor_levels import NUMBER, FamilyName, Levels, Strength
from labcal.bench.distortion.fault_section import FaultNames
from labcal.bench.families.volume import COLS, ROWS
from labcal.bench.faults.faulty_scene import require_rendered
from labcal.bench.faults.registry import fault_named

_SECTION = "rendered."
_LISTS = ("families", "strengths", "faults")


def _can_be_rendered(names: tuple[str, ...]) -> tuple[str, ...]:
    """Return names of faults, all of which the laboratory can make."""
    for name in names:
        require_rendered(fault_named(name))
    return names


class RenderedPlan(BaseModel):
    """Families and strengths whose cameras are rendered; every combination is measured.

    The methods and their settings are those of the plan.

    Examples
    --------
    >>> from labcal.bench.distortion.plan import load_plan
    >>> load_plan("quick", ["rendered.strengths=0,1", "rendered.seeds=3"]).rendered.case_count
    12
    """

    model_config = ConfigDict(frozen=True, extra="forbid")

    families: Levels[FamilyName] = ("brown", "water")
    strengths: Levels[Strength] = (0.0, 0.3, 0.6, 1.0)
    views: Annotated[int, NUMBER, Field(ge=2, le=100)] = 4
    """Heights of the board to train on; there is a test view half-way between each two."""
    spp: Annotated[int, NUMBER, Field(ge=1, le=4096)] = 32
    """Rays a pixel."""
    seeds: Annotated[int, NUMBER, Field(ge=1, le=10**6)] = 1
    """Number of seeds: repetitions with other noise of the sensor and other waves."""
    faults: Annotated[FaultNames, AfterValidator(_can_be_rendered)] = ()
    """Faults of the pictures to train on, each measured in every family at the middle strength."""

    @property
    def case_count(self) -> int:
        """Number of cases, those with a fault included."""
        return len(self.families) * (len(self.strengths) + len(self.faults)) * self.seeds

    @property
    def points(self) -> int:
        """Dots on the board in all training views."""
        return COLS * ROWS * self.views

    @property
    def picture_count(self) -> int:
        """Number of pictures of a case: two cameras, training and test views."""
        return 2 * (2 * self.views - 1)

    def cells(self) -> Iterator[Cell]:
        """Yield the cells, family by family, those with a fault last."""
        for family, strength in product(self.families, self.strengths):
            yield Cell(family, strength, 0.0, self.points, Layout.PLANES, Source.RENDERED)
        middle = median_high(self.strengths)
        for family, fault in product(self.families, self.faults):
            yield Cell(family, middle, 0.0, self.points, Layout.PLANES, Source.RENDERED, fault)

    def cases(self, first: Case) -> list[Case]:
        """Return the cases with the methods and the first seed of a simulated case."""
        pictures = Pictures(self.views, self.spp)
        common = replace(first, regions=(Measured.WITHIN,), pictures=pictures)
        return [
            replace(common, cell=cell, seed=first.seed + number)
            for cell in self.cells()
            for number in range(self.seeds)
        ]


RENDERED_FACTORS = tuple(_SECTION + name for name in RenderedPlan.model_fields)
"""Names by which the section is changed."""


def with_rendered_change(section: object, factor: str, levels: str) -> object:
    """Return the section of a file with other levels of a factor, or another number."""
    name = factor.removeprefix(_SECTION)
    value = [level.strip() for level in levels.split(",")] if name in _LISTS else levels.strip()
    known = section if isinstance(section, dict) else {}
    return {**known, name: value}


def is_rendered_change(change: str) -> bool:
    """Return whether a change ``factor=level`` is one of the section."""
    return change.startswith(_SECTION)
