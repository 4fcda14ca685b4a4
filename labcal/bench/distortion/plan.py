"""The plan of a benchmark of distortion: its factors and their levels, a YAML file."""

import hashlib
import math
from collections.abc import Iterator, Mapping, Sequence
from itertools import product
from typing import Annotated, Any

from pydantic import BaseModel, ConfigDict, Field, model_validator

from labcal.bench.distortion.case import Case, Cell, Layout, Measured, Setting
from labcal.bench.distortion.factor_levels import (
    NUMBER,
    FamilyName,
    Levels,
    MethodName,
    Noise,
    Points,
    Protocols,
    Strength,
)
from labcal.bench.distortion.fault_section import SECTION, FaultSection, fitted_section, strange_level
from labcal.bench.distortion.rendered_plan import RENDERED_FACTORS, RenderedPlan, with_rendered_change
from labcal.errors import InputError, UnknownNameError
from labcal.run.code_version import module_digest
from labcal.run.descriptions import description_content, validate_description
from labcal.run.user_code import SEPARATOR

FOLDER = "labcal/bench/distortion/plans"
QUICK, FULL = "quick", "full"


class Plan(BaseModel):
    """Factors and levels; every combination is measured.

    A case is a combination of family, strength, noise, number of points and layout with a seed; all methods
    are fitted to the same data of a case, and measured in every region.

    Examples
    --------
    >>> from labcal.bench.distortion.plan import load_plan
    >>> plan = load_plan("quick", ["families=water", "strengths=0,1"], seeds=2)
    >>> plan.families, plan.strengths, plan.seeds
    (('water',), (0.0, 1.0), 2)
    """

    model_config = ConfigDict(frozen=True, extra="forbid")

    description: Annotated[str, Field(max_length=4000)] = ""
    methods: Levels[MethodName]
    """Names, or ``package.module:Class``."""
    families: Levels[FamilyName]
    strengths: Levels[Strength]
    """From 0, a pinhole, to 1."""
    noise_px: Levels[Noise]
    """Standard deviation of each coordinate of a pixel, px."""
    points: Levels[Points]
    """Training points; the grids on planes may have a few more."""
    layout: Levels[Layout]
    measured: Levels[Measured]
    seeds: Annotated[int, NUMBER, Field(ge=1, le=10**9)]
    """Number of seeds: repetitions with other noise, other points and other waves."""
    tests: Annotated[int, NUMBER, Field(ge=10, le=100_000)] = 1000
    """Points to measure in each region."""
    settings: Mapping[str, Mapping[str, Setting]] = Field(default_factory=dict)
    """Constructor arguments by method that differ from its defaults."""
    faults: FaultSection = FaultSection()
    """Faults that the methods do not know of, in some of the cells."""
    rendered: RenderedPlan | None = None
    """Cases that are measured through pictures, with the same methods; the usual ones where left out."""
    protocols: Protocols = ()
    """Protocols of others by which all methods are measured besides, once a seed."""

    @model_validator(mode="after")
    def _has_the_reference_cells(self) -> "Plan":
        if reason := strange_level(self.faults, self._levels):
            raise ValueError(reason)
        return self

    @property
    def cell_count(self) -> int:
        """Number of simulated cells, which are not counted one by one."""
        return math.prod(map(len, (self.families, self.strengths, self.noise_px, self.points, self.layout)))

    @property
    def case_count(self) -> int:
        """Number of cases, those with a fault and those of pictures included."""
        pictured = 0 if self.rendered is None else self.rendered.case_count
        return self.cell_count * self.seeds + self.fault_case_count + pictured

    @property
    def fault_case_count(self) -> int:
        """Number of simulated cases with a fault."""
        return self.faults.count(self._levels) * self.fault_seeds

    @property
    def fault_seeds(self) -> int:
        """Number of seeds with which faults are measured: the first ones."""
        return min(self.faults.seeds or self.seeds, self.seeds)

    @property
    def sha256(self) -> str:
        """The hash of all that the plan says."""
        return hashlib.sha256(self.model_dump_json().encode()).hexdigest()

    @property
    def sources(self) -> tuple[str, ...]:
        """Digests of the files of methods of one's own."""
        own = [method for method in self.methods if SEPARATOR in method]
        return tuple(module_digest(method.partition(SEPARATOR)[0]) for method in own)

    def cells(self) -> Iterator[Cell]:
        """Yield the simulated cells, the first factor changing least often."""
        factors = (self.families, self.strengths, self.noise_px, self.points, self.layout)
        for family, strength, noise_px, points, layout in product(*factors):
            yield Cell(family, strength, noise_px, points, layout)

    def fault_cells(self) -> Iterator[Cell]:
        """Yield the cells with a fault."""
        return self.faults.cells(self._levels)

    @property
    def _levels(self) -> dict[str, tuple[Any, ...]]:
        """Levels by factor."""
        return {factor: getattr(self, factor) for factor in _CELL_FACTORS}

    def cases(self, first_seed: int) -> list[Case]:
        """Return all cases, the seeds of a cell together, then those with a fault, those of pictures last."""
        sources = self.sources
        cases = [
            Case(cell, first_seed + number, self.methods, self.measured, self.tests, self.settings, sources)
            for cells, seeds in ((self.cells(), self.seeds), (self.fault_cells(), self.fault_seeds))
            for cell in cells
            for number in range(seeds)
        ]
        return cases if self.rendered is None else [*cases, *self.rendered.cases(cases[0])]


_CELL_FACTORS = ("methods", "families", "strengths", "noise_px", "points", "layout", "measured")
FACTORS = (*_CELL_FACTORS, SECTION, "protocols")


def load_plan(
    name: str, changes: Sequence[str] = (), methods: Sequence[str] = (), seeds: int | None = None
) -> Plan:
    """Return a shipped plan by name, or from a YAML file of one's own, with changes.

    Parameters
    ----------
    name : str
        ``quick``, ``full``, or the path of a file.
    changes : sequence of str
        Each ``factor=level,level``, in the place of the plan's levels; ``rendered.strengths=0,1`` is one of
        the section `rendered`.
    methods : sequence of str
        Methods to measure besides those of the plan.
    seeds : int, optional
        In the place of the plan's number of seeds.

    Raises
    ------
    UnknownNameError
        There is no such plan or factor; the nearest name is offered.
    InputError
        The file cannot be read, or a level is not allowed.
    """
    content, changed = description_content("plan", FOLDER, name), []
    seen: set[str] = set()
    for change in changes:
        factor, equals, levels = change.partition("=")
        if factor in seen:
            raise InputError(
                f"`overrides` changes '{factor}' twice, and only one could hold. Give all its levels at "
                "once, separated by commas."
            )
        seen.add(factor)
        if factor == "seeds":
            raise InputError(f"`overrides` sets '{change}', but seeds are no levels. Give `seeds`, a number.")
        if factor not in (*FACTORS, *RENDERED_FACTORS):
            raise UnknownNameError("factor", factor, (*FACTORS, *RENDERED_FACTORS))
        if not equals or not levels:
            raise InputError(
                f"`overrides` takes a factor and its levels, as in strengths=0,0.5,1, but is '{change}'."
            )
        if factor in RENDERED_FACTORS:
            content["rendered"] = with_rendered_change(content.get("rendered"), factor, levels)
            continue
        _replace(content, factor, [level.strip() for level in levels.split(",")])
        changed.append(factor)
        if factor == "methods" and isinstance(content.get("settings"), dict):
            content["settings"] = {
                method: own for method, own in content["settings"].items() if method in content[factor]
            }
    if seeds is not None:
        content["seeds"] = seeds
    plan = validate_description(Plan, "plan", name, fitted_section(content, changed))
    return plan.model_copy(update={"methods": tuple(dict.fromkeys((*plan.methods, *methods)))})


def _replace(content: dict[str, Any], factor: str, levels: list[str]) -> None:
    """Replace the levels of a factor in the raw content of a plan; the faults keep their reference cells."""
    section = content.get(SECTION)
    if factor == SECTION and isinstance(section, dict):
        content[SECTION] = {**section, "kinds": levels}
    else:
        content[factor] = levels
