"""The plan of a benchmark of distortion: its factors and their levels, a YAML file."""

import hashlib
import math
from collections.abc import Iterator, Mapping, Sequence
from itertools import product
from typing import Annotated, TypeVar

from pydantic import AfterValidator, BaseModel, ConfigDict, Field

from labcal.bench.distortion.case import Case, Cell, Layout, Measured, Setting
from labcal.bench.distortion.protocols.registry import protocol_by_name
from labcal.bench.families.registry import family_by_name
from labcal.errors import InputError, UnknownNameError
from labcal.run.code_version import module_digest
from labcal.run.descriptions import description_content, validate_description
from labcal.run.user_code import SEPARATOR

FOLDER = "labcal/bench/distortion/plans"
QUICK, FULL = "quick", "full"
_MOST_LEVELS = 1000
Level = TypeVar("Level")


def _each_once(levels: tuple[Level, ...]) -> tuple[Level, ...]:
    """Return levels of which none stands twice."""
    if len(set(levels)) < len(levels):
        raise ValueError("a level stands twice; name each once")
    return levels


def _known_family(name: str) -> str:
    return family_by_name(name).name


def _known_protocol(name: str) -> str:
    return protocol_by_name(name).name


Levels = Annotated[
    tuple[Level, ...], Field(min_length=1, max_length=_MOST_LEVELS), AfterValidator(_each_once)
]
"""The levels of a factor."""
FamilyName = Annotated[str, AfterValidator(_known_family)]
ProtocolName = Annotated[str, AfterValidator(_known_protocol)]
MethodName = Annotated[str, Field(min_length=1, max_length=200)]
Strength = Annotated[float, Field(ge=0.0, le=1.0)]
Noise = Annotated[float, Field(ge=1e-4, le=20.0)]
Points = Annotated[int, Field(ge=16, le=4000)]


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
    seeds: Annotated[int, Field(ge=1, le=10**9)]
    """Number of seeds: repetitions with other noise, other points and other waves."""
    tests: Annotated[int, Field(ge=10, le=100_000)] = 1000
    """Points to measure in each region."""
    settings: Mapping[str, Mapping[str, Setting]] = Field(default_factory=dict)
    """Constructor arguments by method that differ from its defaults."""
    protocols: Annotated[tuple[ProtocolName, ...], AfterValidator(_each_once)] = ()
    """Protocols of others by which all methods are measured besides, once a seed."""

    @property
    def cell_count(self) -> int:
        """Number of cells, which are not counted one by one."""
        return math.prod(map(len, (self.families, self.strengths, self.noise_px, self.points, self.layout)))

    @property
    def case_count(self) -> int:
        """Number of cases."""
        return self.cell_count * self.seeds

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
        """Yield the cells, the first factor changing least often."""
        factors = (self.families, self.strengths, self.noise_px, self.points, self.layout)
        for family, strength, noise_px, points, layout in product(*factors):
            yield Cell(family, strength, noise_px, points, layout)

    def cases(self, first_seed: int) -> list[Case]:
        """Return all cases, the seeds of a cell together."""
        sources = self.sources
        return [
            Case(cell, first_seed + number, self.methods, self.measured, self.tests, self.settings, sources)
            for cell in self.cells()
            for number in range(self.seeds)
        ]


FACTORS = ("methods", "families", "strengths", "noise_px", "points", "layout", "measured", "protocols")


def load_plan(
    name: str, changes: Sequence[str] = (), methods: Sequence[str] = (), seeds: int | None = None
) -> Plan:
    """Return a shipped plan by name, or from a YAML file of one's own, with changes.

    Parameters
    ----------
    name : str
        ``quick``, ``full``, or the path of a file.
    changes : sequence of str
        Each ``factor=level,level``, in the place of the plan's levels.
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
    content = description_content("plan", FOLDER, name)
    for change in changes:
        factor, equals, levels = change.partition("=")
        if factor not in FACTORS:
            raise UnknownNameError("factor", factor, FACTORS)
        if not equals or not levels:
            raise InputError(
                f"`overrides` takes a factor and its levels, as in strengths=0,0.5,1, but is '{change}'."
            )
        content[factor] = [level.strip() for level in levels.split(",")]
        if factor == "methods" and isinstance(content.get("settings"), dict):
            content["settings"] = {
                method: own for method, own in content["settings"].items() if method in content[factor]
            }
    if seeds is not None:
        content["seeds"] = seeds
    plan = validate_description(Plan, "plan", name, content)
    return plan.model_copy(update={"methods": tuple(dict.fromkeys((*plan.methods, *methods)))})
