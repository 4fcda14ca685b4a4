"""Solid bodies that occlude the target or stand on the table."""

from enum import StrEnum
from typing import Annotated, Literal

from pydantic import BaseModel, ConfigDict, Field, model_validator

from labcal.bounds import Length
from labcal.scene.camera import Coordinate, Vector
from labcal.scene.quantities import Colour


class Frame(StrEnum):
    """The frame in which coordinates are given."""

    WORLD = "world"
    TARGET = "target"
    """It moves with the target."""


class Box(BaseModel):
    """A solid box."""

    model_config = ConfigDict(frozen=True, extra="forbid")

    kind: Literal["box"]
    frame: Frame = Frame.WORLD
    centre_mm: Vector
    size_mm: tuple[Length, Length, Length]
    """Its sides along its own x, y and z."""
    turn_deg: tuple[Coordinate, Coordinate, Coordinate] = (0.0, 0.0, 0.0)
    """Turns about the frame's X, then Y, then Z."""
    reflectance: Colour = (0.2, 0.2, 0.2)


class Rod(BaseModel):
    """A solid cylinder with flat ends."""

    model_config = ConfigDict(frozen=True, extra="forbid")

    kind: Literal["rod"]
    frame: Frame = Frame.WORLD
    from_mm: Vector
    to_mm: Vector
    diameter_mm: Length
    reflectance: Colour = (0.2, 0.2, 0.2)

    @model_validator(mode="after")
    def _has_a_length(self) -> "Rod":
        if self.from_mm == self.to_mm:
            raise ValueError("from_mm and to_mm must differ")
        return self


Occluder = Annotated[Box | Rod, Field(discriminator="kind")]
