"""``shoot.json``: the input of the measuring arm, without lenses, true poses or scene."""

from collections.abc import Callable
from enum import StrEnum
from typing import Annotated, Literal

from pydantic import BaseModel, ConfigDict, Field, model_serializer, model_validator

from labcal.bounds import MOST_PIXELS, Side
from labcal.cameras.record import PoseRecord
from labcal.run.names import Name, differ_in_case
from labcal.targets.catalogue import DescribedTarget
from labcal.targets.code_text import MOST_COPIES
from labcal.wording import clipped, listed

RelativePath = Annotated[str, Field(pattern=r"^images/[A-Za-z0-9_.-]+$")]


class Role(StrEnum):
    """The role of a view."""

    TRAIN = "train"
    TEST = "test"


class CameraEntry(BaseModel):
    """A camera for the measuring arm: only its picture size."""

    model_config = ConfigDict(frozen=True, extra="forbid")

    size: tuple[Side, Side]
    """Width and height in pixels."""


class ViewEntry(BaseModel):
    """One place of the target, seen by some or all cameras at once."""

    model_config = ConfigDict(frozen=True, extra="forbid")

    name: Name
    """Name of the view: letters, digits and hyphens."""
    images: Annotated[dict[Name, RelativePath], Field(min_length=1)]
    """Picture by camera, relative to the shoot's folder."""
    role: Role
    """Use of the view: methods are fitted to it, or tested with it."""
    T_world_target_nominal: PoseRecord | None
    """Pose that the stage reports, mm; null for a hand-held target."""


class Manifest(BaseModel):
    """The whole of ``shoot.json``."""

    model_config = ConfigDict(frozen=True, extra="forbid")

    format: Literal["labcal-shoot"] = "labcal-shoot"
    """Kind of the file."""
    format_version: Literal[1] = 1
    """Version of the form of the file."""
    target: DescribedTarget | None = None
    """The target as designed; null where it is not known, as of captured pictures."""
    print_number: Annotated[int, Field(ge=0, le=MOST_COPIES)] | None = None
    """Number of the print in its code, 0 for none, where the target was read from the code: other boards in
    the pictures are then hidden. The key is absent where the target was named."""
    cameras: Annotated[dict[Name, CameraEntry], Field(min_length=1)]
    """Cameras by name."""
    views: tuple[ViewEntry, ...]
    """Views in the order in which they were taken."""

    @model_serializer(mode="wrap")
    def _without_number(self, dump: Callable[[BaseModel], dict[str, object]]) -> dict[str, object]:
        return {key: value for key, value in dump(self).items() if key != "print_number" or value is not None}

    @model_validator(mode="after")
    def _names_agree(self) -> "Manifest":
        names = [view.name for view in self.views]
        if len(set(names)) != len(names):
            raise ValueError("two views have the same name")
        for view in self.views:
            unknown = set(view.images) - set(self.cameras)
            if unknown:
                raise ValueError(
                    f"view '{clipped(view.name)}' has pictures of unknown cameras: {listed(sorted(unknown))}"
                )
        known: set[str] = set()
        for picture in (picture for view in self.views for picture in view.images.values()):
            if picture in known:
                raise ValueError(f"the picture '{clipped(picture)}' is that of two cameras or views")
            known.add(picture)
        for kind, given in (("views", names), ("cameras", list(self.cameras)), ("pictures", list(known))):
            alike = differ_in_case(given)
            if alike is not None:
                raise ValueError(
                    f"the {kind} '{clipped(alike[0])}' and '{clipped(alike[1])}' differ only in capital "
                    "letters, so that their files are the same ones on many disks; rename one of them"
                )
        for name, camera in self.cameras.items():
            if camera.size[0] * camera.size[1] > MOST_PIXELS:
                raise ValueError(f"pictures of camera '{clipped(name)}' have more than {MOST_PIXELS} pixels")
        return self
