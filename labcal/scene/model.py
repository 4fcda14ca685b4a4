"""A scene: everything that is in the laboratory, as a person writes it down in YAML."""

from typing import Annotated

import yaml
from pydantic import BaseModel, ConfigDict, Field, field_validator

from labcal.cameras.camera import Camera
from labcal.errors import InputError
from labcal.run.names import Name
from labcal.scene.board import Board
from labcal.scene.camera import CameraDescription
from labcal.scene.lamps import Lamp
from labcal.scene.occluders import Occluder
from labcal.scene.photometry import Photometry
from labcal.scene.placement import Placement
from labcal.scene.room import Room
from labcal.targets.catalogue import load_target
from labcal.targets.grid import DotGrid

PASSES = (64, 16, 8, 4, 2, 1)
"""Samples a pixel that one pass may have: the sampler neither rounds them up nor gives other bytes twice."""


def samples_per_pass(spp: int) -> int:
    """Return how many samples a pixel each of the equal passes has that make up `spp`.

    Raises
    ------
    InputError
        No passes of 64 or 16 make it up, nor a single smaller one.
    """
    for samples in PASSES:
        if spp == samples or (spp > 0 and samples >= 16 and spp % samples == 0):  # noqa: PLR2004 -- see above
            return samples
    raise InputError(f"The samples a pixel should be 1, 2, 4, 8 or a multiple of 16, but are {spp}.")


class Scene(BaseModel):
    """A laboratory: cameras, a target and where it goes, lamps, room, and how the sensors respond."""

    model_config = ConfigDict(frozen=True, extra="forbid")

    name: Name
    description: str = ""
    target: DotGrid
    """The target; in a file the name of one, or its whole description."""
    cameras: Annotated[dict[Name, CameraDescription], Field(min_length=1)]
    placement: Placement
    lamps: Annotated[tuple[Lamp, ...], Field(min_length=1)]
    room: Room = Room()
    board: Board = Board()
    occluders: tuple[Occluder, ...] = ()
    """Solid things in the way, or just there to be seen."""
    photometry: Photometry = Photometry()
    noise: bool = True
    """Photon and read noise; off for tests of the geometry."""
    spp: int = 64
    """Rays a pixel."""

    @field_validator("target", mode="before")
    @classmethod
    def _target_by_name(cls, value: object) -> object:
        return load_target(value) if isinstance(value, str) else value

    @field_validator("spp")
    @classmethod
    def _spp_in_passes(cls, value: int) -> int:
        samples_per_pass(value)
        return value

    def true_cameras(self) -> dict[str, Camera]:
        """Return the cameras by name, in the scene's order.

        Raises
        ------
        InputError
            A camera is impossible; it is named by the lens or the view that cannot be.
        """
        return {name: description.camera() for name, description in self.cameras.items()}

    def with_spp(self, spp: int) -> "Scene":
        """Return the scene with other samples a pixel.

        Raises
        ------
        InputError
            They cannot be traced in passes that give the same bytes each time.
        """
        return self.model_copy(update={"spp": self._spp_in_passes(spp)})

    def to_yaml(self) -> str:
        """Return the scene with all its keys as a file that can be rendered again."""
        text: str = yaml.safe_dump(self.model_dump(mode="json"), sort_keys=False, allow_unicode=True)
        return text
