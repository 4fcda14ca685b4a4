"""A rig: cameras by name in one world, and its file ``rig.json``."""

from collections.abc import Callable
from pathlib import Path
from typing import Annotated, Literal

from pydantic import BaseModel, ConfigDict, Field, model_serializer

from labcal.cameras.camera import Camera
from labcal.cameras.record import CameraRecord
from labcal.errors import InputError
from labcal.run.documents import read_document
from labcal.run.file_kinds import beginning_with
from labcal.run.names import Name, differ_in_case
from labcal.run.outputs import write_file

KIND = beginning_with("a rig.json", b'{\n  "format": "labcal-rig"')
Pixel = Annotated[float, Field(ge=0, allow_inf_nan=False)]
"""A length in px."""


class CalibrationRecord(BaseModel):
    """How well cameras agreed when they were calibrated; what is not known is left out of files."""

    model_config = ConfigDict(frozen=True, extra="forbid")

    triangulation_rms_px: Pixel | None = None
    """RMS triangulation residual of the dots that they were calibrated from."""
    scatter_px: Pixel | None = None
    """What of it is beyond the dots' covariances, as a standard deviation of pixels along each axis."""
    inconsistent: tuple[str, ...] = ()
    """Why the views contradict each other, the likeliest cause first; empty where they do not."""


class Rig(BaseModel):
    """Cameras by name. In a rig from a hand-held target the world is the first camera's frame."""

    model_config = ConfigDict(frozen=True, extra="forbid")

    format: Literal["labcal-rig"] = "labcal-rig"
    """Kind of the file."""
    format_version: Literal[1] = 1
    """Version of the form of the file."""
    cameras: Annotated[dict[Name, CameraRecord], Field(min_length=1)]
    """Cameras by name."""
    calibrated_on: tuple[str, ...] = ()
    """Names of the views that it was calibrated from, where that is known: figures of these are no check."""
    calibration: CalibrationRecord | None = None
    """How well these cameras agreed; left out of the file where nothing is known."""

    @model_serializer(mode="wrap")
    def _without_what_is_not_known(self, dump: Callable[[BaseModel], dict[str, object]]) -> dict[str, object]:
        return {key: value for key, value in dump(self).items() if value not in (None, (), [])}

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


def contradiction_note(rig: Rig) -> str | None:
    """Return what to tell where the views that a rig was calibrated from contradict each other; else None."""
    if rig.calibration is None or not rig.calibration.inconsistent:
        return None
    return (
        f"the views that this rig was calibrated from contradict each other (likely "
        f"{rig.calibration.inconsistent[0]}): do not rely on it. Calibrate again."
    )


def write_rig(path: Path, rig: Rig, *, force: bool = False) -> None:
    """Write ``rig.json``.

    Raises
    ------
    OutputError
        The file exists and `force` is not set, or it cannot be written.
    """
    write_file(path, rig.model_dump_json(indent=2) + "\n", kind=KIND, force=force)


def read_rig(path: Path) -> Rig:
    """Read ``rig.json``.

    Raises
    ------
    InputError
        The file cannot be read, is no rig, comes from a newer version, or a camera in it is impossible.
    """
    return checked_rig(read_document(Rig, "rig", path), str(path))


def checked_rig(rig: Rig, source: str) -> Rig:
    """Return a rig that was read, whatever its file: the one place that asks whether its cameras can be.

    Parameters
    ----------
    rig : Rig
    source : str
        Where it comes from, at the beginning of a sentence.

    Raises
    ------
    InputError
        A camera is impossible, or its lens images nothing in the middle of its picture.
    """
    alike = differ_in_case(rig.cameras)
    if alike is not None:
        raise InputError(
            f"{source}: the cameras '{alike[0]}' and '{alike[1]}' differ only in capital letters, so that "
            "their files would be the same ones on many disks. Rename one of them."
        )
    for name, record in rig.cameras.items():
        try:
            record.sensible_camera(name)
        except InputError as error:
            raise InputError(f"{source}: {error}") from error
    return rig
