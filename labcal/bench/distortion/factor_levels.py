"""Levels of the factors of a plan: types that check what a file says."""

from typing import Annotated, TypeVar

from pydantic import AfterValidator, Field

from labcal.bench.distortion.protocols.registry import protocol_by_name
from labcal.bench.families.registry import family_by_name

_MOST_LEVELS = 1000
Level = TypeVar("Level")


def each_once(levels: tuple[Level, ...]) -> tuple[Level, ...]:
    """Return levels of which none stands twice."""
    if len(set(levels)) < len(levels):
        raise ValueError("a level stands twice; name each once")
    return levels


def _known_family(name: str) -> str:
    return family_by_name(name).name


def _known_protocol(name: str) -> str:
    return protocol_by_name(name).name


Levels = Annotated[tuple[Level, ...], Field(min_length=1, max_length=_MOST_LEVELS), AfterValidator(each_once)]
"""The levels of a factor."""
FamilyName = Annotated[str, AfterValidator(_known_family)]
ProtocolName = Annotated[str, AfterValidator(_known_protocol)]
MethodName = Annotated[str, Field(min_length=1, max_length=200)]
Strength = Annotated[float, Field(ge=0.0, le=1.0)]
Noise = Annotated[float, Field(ge=1e-4, le=20.0)]
Points = Annotated[int, Field(ge=16, le=4000)]
