"""The room around the target: what reflects light, and the lamps that give it."""

from typing import Annotated

from pydantic import BaseModel, ConfigDict, Field

from labcal.scene.camera import Coordinate, Vector

Share = Annotated[float, Field(ge=0, le=1)]
Colour = tuple[Share, Share, Share]
Length = Annotated[float, Field(gt=0, allow_inf_nan=False)]
Positive = Annotated[float, Field(gt=0, allow_inf_nan=False)]


class Lamp(BaseModel):
    """A flat panel that shines to one side, evenly in all directions (a Lambertian emitter)."""

    model_config = ConfigDict(frozen=True, extra="forbid")

    centre_mm: Vector
    look_at_mm: Vector
    size_mm: tuple[Length, Length]
    radiance: Positive
    """Brightness of the panel, in a unit that the exposure takes out again."""
    colour: tuple[Positive, Positive, Positive] = (1.0, 1.0, 1.0)
    """Factors of red, green and blue."""


class Board(BaseModel):
    """How the target is made: a print with diffuse reflectances, on a plate."""

    model_config = ConfigDict(frozen=True, extra="forbid")

    dark: Colour = (0.04, 0.04, 0.04)
    light: Colour = (0.85, 0.85, 0.85)
    plate: Colour = (0.35, 0.36, 0.37)
    """Edges and back of the plate."""
    thickness_mm: Length = 8.0


class Room(BaseModel):
    """Floor, back wall and table; the world's Z points up, lengths are in millimetres."""

    model_config = ConfigDict(frozen=True, extra="forbid")

    floor_z_mm: Coordinate = -800.0
    floor: Colour = (0.30, 0.31, 0.32)
    """Every other tile is a little darker."""
    tile_mm: Length = 500.0
    wall_y_mm: Coordinate = 2600.0
    wall: Colour = (0.55, 0.56, 0.52)
    table_centre_mm: tuple[Coordinate, Coordinate] = (1000.0, 1000.0)
    table_size_mm: tuple[Length, Length] = (1500.0, 1100.0)
    table_z_mm: Coordinate = -60.0
    table: Colour = (0.42, 0.29, 0.18)
    support: Colour = (0.12, 0.13, 0.14)
    """What holds the target up."""
