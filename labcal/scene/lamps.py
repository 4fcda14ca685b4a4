"""The lamps of a scene: panels, ring lights, spotlights and ambient light."""

from typing import Annotated, Any, Literal

from pydantic import BaseModel, ConfigDict, Discriminator, Field, Tag, model_validator

from labcal.bounds import Length, Quantity
from labcal.scene.camera import Vector


class Aimed(BaseModel):
    """The common keys of lamps that have a place and a direction."""

    model_config = ConfigDict(frozen=True, extra="forbid")

    centre_mm: Vector
    look_at_mm: Vector
    colour: tuple[Quantity, Quantity, Quantity] = (1.0, 1.0, 1.0)
    """Factors of red, green and blue."""


class Panel(Aimed):
    """A flat panel that radiates to one side, a Lambertian emitter."""

    kind: Literal["panel"] = "panel"
    size_mm: tuple[Length, Length]
    radiance: Quantity
    """Brightness of the panel, in a unit that the exposure takes out again."""


class Ring(Aimed):
    """A flat ring that radiates to one side like a panel; a camera may look through its hole."""

    kind: Literal["ring"]
    inner_diameter_mm: Length
    outer_diameter_mm: Length
    radiance: Quantity
    """Brightness of the ring, in the unit of a panel's."""

    @model_validator(mode="after")
    def _has_a_width(self) -> "Ring":
        if self.inner_diameter_mm >= self.outer_diameter_mm:
            raise ValueError("inner_diameter_mm must be smaller than outer_diameter_mm")
        return self


class Spot(Aimed):
    """A spotlight: a point source, uniform within its beam and 0 beyond the cutoff angle."""

    kind: Literal["spot"]
    intensity: Quantity
    """Radiance times area, in mm2: along its axis a panel of 100 x 100 mm and radiance 9 has 90000."""
    cutoff_deg: Annotated[float, Field(gt=0, lt=90)]
    """Angle from the axis where the light ends."""
    beam_deg: Annotated[float, Field(ge=0, lt=90)]
    """Angle from the axis up to which the intensity is full; from there it falls linearly to the cutoff."""

    @model_validator(mode="after")
    def _has_a_rim(self) -> "Spot":
        if self.beam_deg >= self.cutoff_deg:
            raise ValueError("beam_deg must be smaller than cutoff_deg")
        return self


class Ambient(BaseModel):
    """Light of the same radiance from all directions, without shadows.

    It stands for what walls and ceiling send back. A surface with reflectance r sends r times `radiance`,
    whatever its place and tilt, so a scene with no other lamp is lit uniformly and without noise.
    """

    model_config = ConfigDict(frozen=True, extra="forbid")

    kind: Literal["ambient"]
    radiance: Quantity
    """In the unit of a panel's."""
    colour: tuple[Quantity, Quantity, Quantity] = (1.0, 1.0, 1.0)
    """Factors of red, green and blue."""


def _kind(lamp: Any) -> str:  # noqa: ANN401 -- what a file holds
    """Return the kind of a lamp; the default is a panel."""
    kind = lamp.get("kind", "panel") if isinstance(lamp, dict) else getattr(lamp, "kind", "panel")
    return str(kind)


Lamp = Annotated[
    Annotated[Panel, Tag("panel")]
    | Annotated[Ring, Tag("ring")]
    | Annotated[Spot, Tag("spot")]
    | Annotated[Ambient, Tag("ambient")],
    Discriminator(
        _kind,
        custom_error_type="lamp_kind",
        custom_error_message="kind should be panel, ring, spot or ambient",
    ),
]
"""A lamp; in a file one without a `kind` is a panel."""
