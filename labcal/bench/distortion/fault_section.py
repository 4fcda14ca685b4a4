"""The section `faults` of a plan: faults by name, and the cells in which they are measured."""

import math
from collections.abc import Iterator, Mapping, Sequence
from itertools import product
from statistics import median_high
from typing import Annotated, Any

from pydantic import AfterValidator, BaseModel, ConfigDict, Field, model_validator

from labcal.bench.distortion.case import NO_FAULT, Cell, Layout
from labcal.bench.distortion.factor_levels import NUMBER, Level, each_once
from labcal.bench.faults.registry import fault_named

_MOST_FAULTS = 1000


def _canonical(name: str) -> str:
    """Return the name of a fault with its size."""
    return name if name == NO_FAULT else fault_named(name).name


def _without_none(names: tuple[str, ...]) -> tuple[str, ...]:
    """Return names of faults; `none` stands for no fault, and no name may stand twice."""
    if len(set(names)) < len(names):
        raise ValueError("a fault stands twice; name each once")
    return tuple(name for name in names if name != NO_FAULT)


FaultNames = Annotated[
    tuple[Annotated[str, AfterValidator(_canonical)], ...],
    Field(max_length=_MOST_FAULTS),
    AfterValidator(_without_none),
]
"""Names of faults with their sizes."""
_Some = Annotated[tuple[Level, ...], AfterValidator(each_once)]
"""Some of the plan's levels of a factor."""


class FaultSection(BaseModel):
    """Faults that the methods do not know of, and reference cells, which are cells of the plan.

    In YAML and on the command line a list of names alone is a section, too.

    Examples
    --------
    >>> from labcal.bench.distortion.fault_section import FaultSection
    >>> FaultSection.model_validate(["pitch", "bend-2"]).kinds
    ('pitch-0.001', 'bend-2')
    """

    model_config = ConfigDict(frozen=True, extra="forbid")

    kinds: FaultNames = ()
    """Names of faults with their sizes."""
    families: _Some[str] = ()
    """Of the plan's families; all of them where left out."""
    strengths: _Some[Annotated[float, NUMBER]] = ()
    """Of the plan's strengths; the middle one where left out."""
    noise_px: _Some[Annotated[float, NUMBER]] = ()
    """Of the plan's; the least where left out."""
    points: _Some[Annotated[int, NUMBER]] = ()
    """Of the plan's; the most where left out."""
    seeds: Annotated[int, NUMBER, Field(ge=1)] | None = None
    """Number of seeds, at most the plan's; all of them where left out."""

    @model_validator(mode="before")
    @classmethod
    def _list_is_of_kinds(cls, value: Any) -> Any:  # noqa: ANN401 -- as pydantic calls it
        return {"kinds": value} if isinstance(value, list | tuple) else value

    def count(self, levels: Mapping[str, Sequence[Any]]) -> int:
        """Return the number of cells with a fault, which are not counted one by one."""
        return math.prod(map(len, self._reference(levels))) * len(self.kinds)

    def cells(self, levels: Mapping[str, Sequence[Any]]) -> Iterator[Cell]:
        """Yield the cells with a fault, of planes and simulated, given the levels of the plan by factor."""
        for (family, strength, noise_px, points), fault in product(
            product(*self._reference(levels)), self.kinds
        ):
            yield Cell(family, strength, noise_px, points, Layout.PLANES, fault=fault)

    def _reference(self, levels: Mapping[str, Sequence[Any]]) -> tuple[Sequence[Any], ...]:
        """Return the levels of each factor in which faults are measured."""
        return (
            self.families or levels["families"],
            self.strengths or (median_high(levels["strengths"]),),
            self.noise_px or (min(levels["noise_px"]),),
            self.points or (max(levels["points"]),),
        )


SECTION = "faults"
_NARROWED = ("families", "strengths", "noise_px", "points")


def strange_level(section: FaultSection, levels: Mapping[str, Sequence[Any]]) -> str | None:
    """Return a reason why a plan with these levels has no such reference cells; None if it has."""
    if section.kinds and Layout.PLANES not in levels["layout"]:
        given = ", ".join(map(str, levels["layout"]))
        return f"faults are those of a board on planes, but the layout is {given}"
    for factor in _NARROWED:
        own = [level for level in getattr(section, factor) if level not in levels[factor]]
        if own:
            return f"the section `{SECTION}` names {own[0]} of `{factor}`, which the plan does not measure"
    return None


def fitted_section(content: dict[str, Any], changed: Sequence[str]) -> dict[str, Any]:
    """Return the raw content of a plan whose section of faults follows changes of the plan's levels.

    Reference levels that the plan has no more are left out, and so are the faults of a board where planes
    are.

    Parameters
    ----------
    content : dict
        The plan, with changed levels as texts.
    changed : sequence of str
        The factors that were changed.
    """
    section = content.get(SECTION)
    if isinstance(section, list):
        section = {"kinds": section}
    if not isinstance(section, dict):
        return content
    section = dict(section)
    if "layout" in changed and SECTION not in changed and Layout.PLANES not in content["layout"]:
        section["kinds"] = []
    for factor in (name for name in _NARROWED if name in changed and isinstance(section.get(name), list)):
        section[factor] = [level for level in section[factor] if _among(level, content[factor])]
    return {**content, SECTION: section}


def _among(level: object, texts: Sequence[str]) -> bool:
    """Return whether a level is one of texts, in whatever way numbers are written."""
    return any(str(level) == text or _number(level) == _number(text) for text in texts)


def _number(level: object) -> float:
    """Return a level as a number; NaN, which equals nothing, if it is none."""
    try:
        return float(str(level))
    except ValueError:
        return float("nan")
