"""The room around the target: its objects and their reflectances."""

from pydantic import BaseModel, ConfigDict

from labcal.bounds import Length
from labcal.scene.camera import Coordinate
from labcal.scene.quantities import Colour


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
    """Support of the target."""
