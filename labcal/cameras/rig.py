"""A rig: cameras by name in one world, and its file ``rig.json``."""

from pathlib import Path
from typing import Annotated, Literal

from pydantic import BaseModel, ConfigDict, Field

from labcal.cameras.camera import Camera
from labcal.cameras.record import CameraRecord
from labcal.errors import InputError
from labcal.run.claims import beginning_with
from labcal.run.documents import read_document
from labcal.run.names import Name
from labcal.run.outputs import write_file

KIND = beginning_with("a rig.json", b'{\n  "format": "labcal-rig"')


class Rig(BaseModel):
    """Cameras by name. In a rig from a hand-held target the world is the first camera's frame."""

    model_config = ConfigDict(frozen=True, extra="forbid")

    format: Literal["labcal-rig"] = "labcal-rig"
    format_version: Literal[1] = 1
    cameras: Annotated[dict[Name, CameraRecord], Field(min_length=1)]

    @classmethod
    def of(cls, cameras: dict[str, Camera]) -> "Rig":
        """Return the rig of these cameras, in their order."""
        return cls(cameras={name: CameraRecord.of(camera) for name, camera in cameras.items()})

    def camera(self, name: str) -> Camera:
        """Return one camera.

        Raises
        ------
        InputError
            The rig has no camera of that name.
        """
        if name not in self.cameras:
            raise InputError(f"The rig has no camera '{name}', only {', '.join(self.cameras)}.")
        return self.cameras[name].camera()


def write_rig(path: Path, rig: Rig, *, force: bool = False) -> None:
    """Write ``rig.json``.

    Raises
    ------
    OutputError
        The file exists and `force` is not set, or it cannot be written.
    """
    write_file(path, rig.model_dump_json(indent=2) + "\n", force=force)


def read_rig(path: Path) -> Rig:
    """Read ``rig.json``.

    Raises
    ------
    InputError
        The file cannot be read, is no rig, or comes from a newer version.
    """
    return read_document(Rig, "rig", path)
