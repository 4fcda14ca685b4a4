"""The model of a scene: everything in the laboratory, as written in YAML."""

from typing import Annotated

import yaml
from pydantic import BaseModel, ConfigDict, Field, field_validator, model_validator

from labcal.bounds import Amount
from labcal.cameras.camera import Camera
from labcal.errors import InputError
from labcal.run.names import Name, differ_in_case
from labcal.scene.board import Board
from labcal.scene.camera import CameraDescription
from labcal.scene.lamps import Lamp
from labcal.scene.mistakes import Mistake
from labcal.scene.motion import Motion, ShutterKind
from labcal.scene.occluders import Occluder
from labcal.scene.photometry import Photometry
from labcal.scene.placement import Placement
from labcal.scene.room import Room
from labcal.targets.board_set import BoardSet, Mounting
from labcal.targets.catalogue import DescribedTarget, described_target
from labcal.targets.grid import DotGrid
from labcal.targets.one_kind import grid_of
from labcal.targets.one_sheet import require_one_sheet

MOST_SAMPLES = 65536
MOST_MISTAKE = 100.0


class _WrittenOut(yaml.SafeDumper):
    """A YAML writer without aliases."""

    def ignore_aliases(self, data: object) -> bool:  # noqa: ARG002 -- PyYAML's own signature
        """Return True: no node is written as an alias."""
        return True


class Scene(BaseModel):
    """A laboratory: cameras, target and its placement, lamps, room, and sensors."""

    model_config = ConfigDict(frozen=True, extra="forbid")

    name: Name
    """Name of the scene: letters, digits and hyphens."""
    description: str = ""
    """Description of the scene, for people."""
    target: DescribedTarget
    """The target; in a file the name of one, or its whole description; a list: boards side by side."""
    cameras: Annotated[dict[Name, CameraDescription], Field(min_length=1)]
    """Cameras by name."""
    placement: Placement
    """Poses of the target, one for each view."""
    lamps: Annotated[tuple[Lamp, ...], Field(min_length=1)]
    """Lamps, one at least."""
    room: Room = Room()
    """Floor, back wall and table."""
    board: Board = Board()
    """Print and plate of the target, with their defects."""
    occluders: tuple[Occluder, ...] = ()
    """Solid bodies that occlude the target or are only visible."""
    photometry: Photometry = Photometry()
    """The sensors; in a file the name of a preset, a preset with changes, or the whole description."""
    motion: Motion = Motion()
    """Movement of the target during an exposure."""
    shutter: ShutterKind = ShutterKind.GLOBAL
    """Exposure of the rows: all at once, or one after another."""
    readout_ms: Amount = 0.0
    """With a rolling shutter, the time from the first row's exposure to the last one's."""
    mistake: Mistake | None = None
    """Something that goes wrong on purpose; `none` is nothing."""
    mistake_size: Annotated[float, Field(gt=0, le=MOST_MISTAKE, allow_inf_nan=False)] | None = None
    """Size of the mistake, as a multiple of its usual size, which is the default."""
    noise: bool = True
    """Whatever is random in the sensors: photon and read noise, fixed patterns; off to test the geometry."""
    spp: Annotated[int, Field(ge=1, le=MOST_SAMPLES)] = 64
    """Rays a pixel."""

    @field_validator("target", mode="before")
    @classmethod
    def _target_by_name(cls, value: object) -> object:
        return described_target(value) if isinstance(value, str | list | tuple) else value

    @field_validator("target")
    @classmethod
    def _boards_are_on_one_plate(cls, target: object) -> object:
        if isinstance(target, BoardSet):
            if target.mounting is Mounting.SEPARATE:
                raise ValueError(
                    f"the boards of '{target.name}' move separately, but the laboratory holds one plate: "
                    f"take one of them, such as '{target.names[0]}', or state that they are fixed to one "
                    "plate: 'mounting: rigid'"
                )
            try:
                require_one_sheet(target)
            except InputError as error:
                raise ValueError(str(error)) from error
        return target

    @field_validator("mistake", mode="before")
    @classmethod
    def _none_is_no_mistake(cls, value: object) -> object:
        return None if value == "none" else value

    @model_validator(mode="after")
    def _readout_is_of_a_rolling_shutter(self) -> "Scene":
        if (self.shutter is ShutterKind.ROLLING) != (self.readout_ms > 0.0):
            raise ValueError(
                "a rolling shutter needs a readout_ms above 0, and a global one has none: set shutter and "
                "readout_ms together"
            )
        return self

    @model_validator(mode="after")
    def _camera_names_differ(self) -> "Scene":
        if alike := differ_in_case(self.cameras):
            raise ValueError(f"the cameras '{alike[0]}' and '{alike[1]}' differ only in capital letters")
        return self

    @property
    def grid(self) -> DotGrid:
        """The target, where it is a grid of dots.

        Raises
        ------
        InputError
            It is of another kind.
        """
        return grid_of(self.target, f"In the scene '{self.name}' this takes")

    def true_cameras(self) -> dict[str, Camera]:
        """Return the cameras by name, in the scene's order.

        Raises
        ------
        InputError
            A camera is impossible; it is named by the lens or the view that cannot be.
        """
        return {name: description.camera() for name, description in self.cameras.items()}

    def with_spp(self, spp: int) -> "Scene":
        """Return the scene with another number of samples per pixel.

        Raises
        ------
        InputError
            There are too few or too many.
        """
        if not 1 <= spp <= MOST_SAMPLES:
            raise InputError(f"The rays a pixel (spp) should be 1 to {MOST_SAMPLES}, but are {spp}.")
        return self.model_copy(update={"spp": spp})

    def to_yaml(self) -> str:
        """Return the scene with all its keys as a file that can be rendered again."""
        usual = {"mistake_size"} if self.mistake_size is None else set()
        content = self.model_dump(mode="json", exclude=usual)
        text: str = yaml.dump(content, Dumper=_WrittenOut, sort_keys=False, allow_unicode=True)
        return text
