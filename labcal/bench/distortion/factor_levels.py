"""Levels of the factors of a plan: types that check what a file says."""

from typing import Annotated, TypeVar

from pydantic import AfterValidator, BeforeValidator, Field

from labcal.bench.distortion.protocols.registry import protocol_by_name
from labcal.bench.families.registry import family_by_name

NO_PROTOCOL = "none"
_MOST_LEVELS = 1000
Level = TypeVar("Level")


def each_once(levels: tuple[Level, ...]) -> tuple[Level, ...]:
    """Return levels of which none stands twice.

    Results are named by six digits of a number, so that numbers which agree in these count as the same.
    """
    if len({_six_digits(level) for level in levels}) < len(levels):
        raise ValueError(
            "a level stands twice; name each once, numbers with other digits among the first six"
        )
    return levels


def _six_digits(level: object) -> object:
    return f"{level:g}" if isinstance(level, float) else level


def _no_truth_value(value: object) -> object:
    """Return what a file says of a number; true and false would count as 1 and 0."""
    if isinstance(value, bool):
        raise ValueError(f"{str(value).lower()} is no number")  # noqa: TRY004 -- pydantic shows ValueError alone
    return value


def _known_family(name: str) -> str:
    return family_by_name(name).name


def _known_protocol(name: str) -> str:
    return protocol_by_name(name).name


def _without_none(names: object) -> object:
    """Return names of a list; `none` stands for nothing, as among faults."""
    return [name for name in names if name != NO_PROTOCOL] if isinstance(names, list | tuple) else names


Levels = Annotated[tuple[Level, ...], Field(min_length=1, max_length=_MOST_LEVELS), AfterValidator(each_once)]
"""The levels of a factor."""
FamilyName = Annotated[str, AfterValidator(_known_family)]
Protocols = Annotated[
    tuple[Annotated[str, AfterValidator(_known_protocol)], ...],
    BeforeValidator(_without_none),
    AfterValidator(each_once),
]
"""Names of protocols; there may be none."""
MethodName = Annotated[str, Field(min_length=1, max_length=200)]
NUMBER = BeforeValidator(_no_truth_value)
"""Annotation of a number, in whose place a file must not say true or false."""
Strength = Annotated[float, NUMBER, Field(ge=0.0, le=1.0)]
Noise = Annotated[float, NUMBER, Field(ge=1e-4, le=20.0)]
Points = Annotated[int, NUMBER, Field(ge=16, le=4000)]
