"""Placement of the target of a scene: on a stage, at known places, or in the hand."""

from abc import abstractmethod
from itertools import pairwise
from typing import Annotated, Literal

import numpy as np
from pydantic import BaseModel, ConfigDict, Field, model_validator

from labcal.bounds import Margin
from labcal.rng import generator
from labcal.run.names import Name, differ_in_case
from labcal.scene.camera import Coordinate, Vector
from labcal.shoot.manifest import Role

Degrees = Annotated[float, Field(ge=0, le=180)]
Views = Annotated[int, Field(ge=0, le=1000)]
Shift = tuple[Coordinate, Coordinate]
NO_SHIFT = (0.0, 0.0)
HALF_A_PITCH = (0.5, 0.5)


class StageView(BaseModel):
    """One place on the stage: the target is level and faces up, its x and y along X and Y of the world."""

    model_config = ConfigDict(frozen=True, extra="forbid")

    name: Name
    role: Role
    origin_mm: Vector
    """Position of dot (0, 0)."""
    shift_pitches: Shift = NO_SHIFT
    """A further move along x and y, in steps of the target's grid."""


class Stage(BaseModel):
    """Places that the stage reports; they are the nominal poses of the views."""

    model_config = ConfigDict(frozen=True, extra="forbid")

    @abstractmethod
    def places(self, seed: int) -> tuple[StageView, ...]:
        """Return the places in order; `seed` is the seed of the run."""


class ListedPlaces(Stage):
    """A list of places."""

    kind: Literal["stage"]
    views: Annotated[tuple[StageView, ...], Field(min_length=1)]

    @model_validator(mode="after")
    def _names_differ(self) -> "ListedPlaces":
        require_different_names([view.name for view in self.views])
        return self

    def places(self, seed: int) -> tuple[StageView, ...]:  # noqa: ARG002 -- nothing is drawn
        """Return the places in the listed order."""
        return self.views


class EvenHeights(BaseModel):
    """Heights at equal intervals."""

    model_config = ConfigDict(frozen=True, extra="forbid")

    first: Coordinate
    last: Coordinate
    count: Annotated[int, Field(ge=1, le=1000)]


class Planes(Stage):
    """Horizontal planes for training, and planes half-way between them for testing."""

    kind: Literal["planes"]
    origin_mm: Shift
    """X and Y of dot (0, 0) without a shift."""
    heights_mm: Annotated[tuple[Coordinate, ...], Field(min_length=1, max_length=1000)] | EvenHeights
    """Z of the planes to train on: a list, or ``first``, ``last`` and ``count``."""
    shifts_pitches: Annotated[tuple[Shift, ...], Field(min_length=1, max_length=100)] = (NO_SHIFT,)
    """Moves along x and y at which each plane is taken, in steps of the target's grid."""
    test_shifts_pitches: Annotated[tuple[Shift, ...], Field(max_length=100)] = (HALF_A_PITCH,)
    """The same for each plane between; none: no tests."""

    def places(self, seed: int) -> tuple[StageView, ...]:  # noqa: ARG002 -- nothing is drawn
        """Return the training planes in the given order, then the test planes from the lowest."""
        heights = self.heights_mm
        if isinstance(heights, EvenHeights):
            heights = tuple(np.linspace(heights.first, heights.last, heights.count).tolist())
        ordered = sorted(heights)
        between = tuple(0.5 * (low + high) for low, high in pairwise(ordered))
        return (
            *self._taken("train", Role.TRAIN, heights, self.shifts_pitches),
            *self._taken("test-between", Role.TEST, between, self.test_shifts_pitches),
        )

    def _taken(
        self, name: str, role: Role, heights: tuple[float, ...], shifts: tuple[Shift, ...]
    ) -> tuple[StageView, ...]:
        """Return each plane at each shift, with the shift in the name if there are several."""
        return tuple(
            StageView(
                name=f"{name}-{plane}" if len(shifts) == 1 else f"{name}-{plane}-{number}",
                role=role,
                origin_mm=(*self.origin_mm, height),
                shift_pitches=shift,
            )
            for plane, height in enumerate(heights, start=1)
            for number, shift in enumerate(shifts, start=1)
        )


class Volume(Stage):
    """A volume: the target at random heights with small random shifts."""

    kind: Literal["volume"]
    origin_mm: Shift
    """X and Y of dot (0, 0) without a shift."""
    heights_mm: tuple[Coordinate, Coordinate]
    """Lowest and highest Z."""
    shift_pitches: tuple[Margin, Margin] = HALF_A_PITCH
    """Largest shift to either side along x and y, in steps of the target's grid."""
    train: Views
    test: Views

    @model_validator(mode="after")
    def _has_views_and_a_range(self) -> "Volume":
        if self.train + self.test == 0:
            raise ValueError("train and test are both 0, so there are no views")
        if self.heights_mm[0] > self.heights_mm[1]:
            raise ValueError("heights_mm should be the lowest and the highest, in this order")
        return self

    def places(self, seed: int) -> tuple[StageView, ...]:
        """Draw the places, each from its own stream of random numbers."""
        return tuple(
            self._drawn(f"{role.value}-{number:02d}", role, seed)
            for role, count in ((Role.TRAIN, self.train), (Role.TEST, self.test))
            for number in range(1, count + 1)
        )

    def _drawn(self, name: str, role: Role, seed: int) -> StageView:
        """Draw one place."""
        random = generator(seed, "volume", name)
        x, y = random.uniform(-1.0, 1.0, 2) * np.array(self.shift_pitches)
        low = self.heights_mm[0]
        high = max(self.heights_mm)  # of 0.0 and -0.0 the first, since NumPy takes -0.0 for lower
        return StageView(
            name=name,
            role=role,
            origin_mm=(*self.origin_mm, float(random.uniform(low, high))),
            shift_pitches=(float(x), float(y)),
        )


class Handheld(BaseModel):
    """Poses that cover pictures and angles, chosen from random ones; they are not nominal poses."""

    model_config = ConfigDict(frozen=True, extra="forbid")

    kind: Literal["handheld"]
    train: Views
    test: Views
    centre_mm: Vector
    """Mean place of the target's middle."""
    spread_mm: tuple[Margin, Margin, Margin]
    """Half the range of that place along X, Y and Z."""
    tilt_max_deg: Annotated[float, Field(ge=0, lt=90)] = 45.0
    """Largest angle of the target's normal to the line towards the middle of the cameras."""
    roll_max_deg: Degrees = 180.0
    """Largest turn about the normal."""
    visible_share: Annotated[float, Field(gt=0, le=1)] = 0.6
    """Share of the dots that every camera must see whole."""
    all_rings: bool = True
    """True if every camera must see all three rings whole, or all dots if there are no rings; of a
    chessboard the corners of its marked squares, or all."""

    @model_validator(mode="after")
    def _has_views(self) -> "Handheld":
        if self.train + self.test == 0:
            raise ValueError("train and test are both 0, so there are no views")
        return self


class PosedView(BaseModel):
    """One pose of a target held in the hand."""

    model_config = ConfigDict(frozen=True, extra="forbid")

    name: Name
    role: Role
    origin_mm: Vector
    """Position of dot (0, 0)."""
    rotation_rad: Vector
    """Rotation vector from the target's frame to the world."""


class HeldPoses(BaseModel):
    """A target held in the hand at listed poses, which are not nominal poses."""

    model_config = ConfigDict(frozen=True, extra="forbid")

    kind: Literal["poses"]
    views: Annotated[tuple[PosedView, ...], Field(min_length=1, max_length=1000)]

    @model_validator(mode="after")
    def _names_differ(self) -> "HeldPoses":
        require_different_names([view.name for view in self.views])
        return self


def require_different_names(names: list[str]) -> None:
    """Require that views have different names, in capital letters alone, too."""
    if len(set(names)) != len(names):
        raise ValueError("two views have the same name")
    if alike := differ_in_case(names):
        raise ValueError(f"the views '{alike[0]}' and '{alike[1]}' differ only in capital letters")


Placement = Annotated[ListedPlaces | Planes | Volume | Handheld | HeldPoses, Field(discriminator="kind")]
