"""How a scene places its target: on a stage, at places known to the measuring arm, or in the hand."""

from typing import Annotated, Literal

from pydantic import BaseModel, ConfigDict, Field, model_validator

from labcal.run.names import Name
from labcal.scene.camera import Coordinate, Vector
from labcal.shoot.manifest import Role

Degrees = Annotated[float, Field(ge=0, le=180)]


class StageView(BaseModel):
    """One place on the stage: the target lies level, facing up, its x and y along the world's X and Y."""

    model_config = ConfigDict(frozen=True, extra="forbid")

    name: Name
    role: Role
    origin_mm: Vector
    """Where dot (0, 0) is."""
    shift_pitches: tuple[Coordinate, Coordinate] = (0.0, 0.0)
    """A further move along x and y, in steps of the target's grid."""


class Stage(BaseModel):
    """Places that the stage reports, so that they are the views' nominal poses."""

    model_config = ConfigDict(frozen=True, extra="forbid")

    kind: Literal["stage"]
    views: Annotated[tuple[StageView, ...], Field(min_length=1)]

    @model_validator(mode="after")
    def _names_differ(self) -> "Stage":
        names = [view.name for view in self.views]
        if len(set(names)) != len(names):
            raise ValueError("two views have the same name")
        return self


class Handheld(BaseModel):
    """Poses drawn at random that cover the pictures and the angles; nobody is told of them."""

    model_config = ConfigDict(frozen=True, extra="forbid")

    kind: Literal["handheld"]
    train: Annotated[int, Field(ge=0, le=1000)]
    test: Annotated[int, Field(ge=0, le=1000)]
    centre_mm: Vector
    """Mean place of the target's middle."""
    spread_mm: tuple[
        Annotated[float, Field(ge=0)], Annotated[float, Field(ge=0)], Annotated[float, Field(ge=0)]
    ]
    """Half the range of that place along X, Y and Z."""
    tilt_max_deg: Annotated[float, Field(ge=0, lt=90)] = 45.0
    """Largest angle of the target's normal to the line towards the middle of the cameras."""
    roll_max_deg: Degrees = 180.0
    """Largest turn about the normal."""

    @model_validator(mode="after")
    def _has_views(self) -> "Handheld":
        if self.train + self.test == 0:
            raise ValueError("train and test are both 0, so there are no views")
        return self


Placement = Annotated[Stage | Handheld, Field(discriminator="kind")]
