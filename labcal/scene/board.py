"""The board of a target, and its defects; each defect is off unless a scene asks for it."""

from collections.abc import Callable
from typing import Annotated

from pydantic import BaseModel, ConfigDict, Field, model_serializer

from labcal.bounds import Length
from labcal.scene.quantities import Colour, Deviation
from labcal.targets.code_text import MOST_COPIES

Factor = Annotated[float, Field(ge=0.5, le=2)]
Rise = Annotated[float, Field(ge=-500, le=500)]
Shift = tuple[Rise, Rise]
_MOST_DOTS = 1_000_000


class Bend(BaseModel):
    """The deviation of a board from a plane: a paraboloid with a twist, tangent to the plane in its middle.

    With a and b the place on the board over its half width and half height, from -1 to 1, the height is
    ``along_x_mm a^2 + along_y_mm b^2 + twist_mm a b``, towards the viewer. The bend lifts every point of the
    print straight up: x and y stay as they are, so the paper is stretched a little.
    """

    model_config = ConfigDict(frozen=True, extra="forbid")

    along_x_mm: Rise = 0.0
    """Height of the middles of the left and right edges."""
    along_y_mm: Rise = 0.0
    """Height of the middles of the lower and upper edges."""
    twist_mm: Rise = 0.0
    """Height that the twist adds at the lower left and upper right corners, and subtracts at the others."""

    @property
    def is_flat(self) -> bool:
        """True if the board is not bent."""
        return self.along_x_mm == 0.0 and self.along_y_mm == 0.0 and self.twist_mm == 0.0


class Board(BaseModel):
    """The material of the target: a print with diffuse reflectances, on a plate."""

    model_config = ConfigDict(frozen=True, extra="forbid")

    dark: Colour = (0.04, 0.04, 0.04)
    """Reflectance of the dots in red, green and blue, 0 to 1."""
    light: Colour = (0.85, 0.85, 0.85)
    """Reflectance of the paper in red, green and blue, 0 to 1."""
    plate: Colour = (0.35, 0.36, 0.37)
    """Edges and back of the plate."""
    thickness_mm: Length = 8.0
    """Thickness of the plate."""
    gloss_roughness: Annotated[float, Field(ge=0.02, le=1)] | None = None
    """Roughness (alpha of the GGX distribution) of a clear coat of index 1.5; none: matt paper."""
    unevenness: Annotated[float, Field(ge=0, le=0.1)] = 0.0
    """Standard deviation of the paper's reflectance from place to place, as a share of it."""
    bend: Bend = Bend()
    """Bend of the board; flat where left out."""
    print_scale: tuple[Factor, Factor] = (1.0, 1.0)
    """Scale of the print along x and y, about the middle of the board; dots are scaled, too."""
    print_shear: Annotated[float, Field(ge=-0.5, le=0.5)] = 0.0
    """Shift of the print along x per millimetre along y, about the middle of the board."""
    misplacement_mm: Deviation = 0.0
    """Standard deviation of each dot's place along x and along y; the same print in all views of a run."""
    print_number: Annotated[int, Field(ge=0, le=MOST_COPIES)] | None = None
    """Number in the code of the print, 0 for none: the board is then the sheet as it is cut out, with code,
    ruler and captions; left out, the bare target without them."""
    dot_shifts_mm: Annotated[tuple[Shift, ...], Field(max_length=_MOST_DOTS)] = ()
    """Shift of each dot along x and y, as of a print that was measured; row by row, none where left out."""

    @model_serializer(mode="wrap")
    def _without_unset(self, dump: Callable[[BaseModel], dict[str, object]]) -> dict[str, object]:
        unset = {"dot_shifts_mm": not self.dot_shifts_mm, "print_number": self.print_number is None}
        return {key: value for key, value in dump(self).items() if not unset.get(key, False)}
