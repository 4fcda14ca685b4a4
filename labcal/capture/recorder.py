"""Pictures into a shoot, view after view; what is there is a whole shoot at every moment."""

from collections.abc import Iterator, Sequence
from dataclasses import dataclass, replace
from typing import Literal

from pydantic import BaseModel, ConfigDict

from labcal.cameras.record import matrix4_record
from labcal.capture.source import CameraInfo, Encoded, Frame, FrameSet
from labcal.detect.codes.reading import read_codes
from labcal.run.documents import read_document
from labcal.run.growing import GrowingFolder
from labcal.run.made import make_folder
from labcal.run.names import Name
from labcal.run.outputs import write_file
from labcal.shoot.dataset import MANIFEST, write_manifest
from labcal.shoot.manifest import CameraEntry, Manifest, ViewEntry
from labcal.shoot.pictures import encoded_picture, read_picture
from labcal.targets.catalogue import AnyTarget
from labcal.targets.print_scale import AnyPrintScale, as_printed

RECORD = "capture.json"
"""Name of the record of a capture, beside the manifest."""


class TakenPicture(BaseModel):
    """Time and settings of one picture."""

    model_config = ConfigDict(frozen=True, extra="forbid")

    view: Name
    """Name of the view."""
    camera: Name
    """Name of the camera."""
    image: str
    """Path of the picture in the shoot."""
    device: str
    """The device in its own words."""
    time_s: float | None
    """Seconds since 1970, or since the beginning of a recording; null where nothing tells."""
    exposure_us: float | None
    """Exposure time, microseconds; null where the device does not tell."""
    gain: float | None
    """Gain in the device's unit; null where it does not tell."""
    number: int | None
    """Number that the device or the recording gives the picture."""


class CaptureRecord(BaseModel):
    """``capture.json``: how each picture of a captured shoot was taken."""

    model_config = ConfigDict(frozen=True, extra="forbid")

    format: Literal["labcal-capture"] = "labcal-capture"
    """Kind of the file."""
    format_version: Literal[1] = 1
    """Version of the form of the file."""
    notes: tuple[str, ...] = ()
    """Settings of the devices that could not be read, set or locked."""
    pictures: tuple[TakenPicture, ...] = ()
    """In the order in which they were taken."""
    dropped: tuple[Name, ...] = ()
    """Names of views that were taken out of the shoot again; a recording does not deliver them once more."""


@dataclass
class Recorder:
    """Writes the sets of a source into a folder that grows.

    Parameters
    ----------
    folder : GrowingFolder
    target : AnyTarget or None
        The target that the pictures show, where it is known; else it may be read from them.
    cameras : sequence of CameraInfo
    print_scale : str, float or tuple of float, optional
        That of the print, for a target that is read from its code.
    """

    folder: GrowingFolder
    target: AnyTarget | None
    cameras: Sequence[CameraInfo]
    print_scale: AnyPrintScale | None = None

    def __post_init__(self) -> None:
        """Read what an interrupted run has recorded already."""
        path = self.folder.path
        self.target_notes: tuple[str, ...] = ()
        self._print_number: int | None = None
        self._views: list[ViewEntry] = []
        self._sizes: dict[str, CameraEntry] = {}
        self._record = CaptureRecord(notes=tuple(note for one in self.cameras for note in one.notes))
        if (path / MANIFEST).is_file() and (path / RECORD).is_file():
            begun = read_document(Manifest, "manifest", path / MANIFEST)
            self._views, self._sizes = list(begun.views), dict(begun.cameras)
            self._record = read_document(CaptureRecord, "record of a capture", path / RECORD)
            if self.target is None:
                self.target, self._print_number = begun.target, begun.print_number

    @property
    def views(self) -> tuple[str, ...]:
        """Names of the views that are in the shoot."""
        return tuple(view.name for view in self._views)

    @property
    def dropped(self) -> tuple[str, ...]:
        """Names of the views that were taken out again."""
        return self._record.dropped

    def free_name(self, wanted: str | None) -> str:
        """Return the name of the next view: the one that its source gives, else the next number."""
        if wanted is not None and wanted not in self.views:
            return wanted
        numbers = [int(name[5:]) for name in self.views if name[:5] == "view-" and name[5:].isdecimal()]
        return f"view-{1 + max([len(self._views), *numbers]):03d}"

    def recorded(self) -> Iterator[tuple[str, FrameSet]]:
        """Read the views that an interrupted run has recorded, one after another, with their names."""
        for view in self._views:
            frames = {
                name: Frame(read_picture(self.folder.path / image)) for name, image in view.images.items()
            }
            yield view.name, FrameSet(frames, view.name, role=view.role, target=self.target)

    def refusal(self, frames: FrameSet) -> str | None:
        """Return why a set does not fit the shoot: a camera is missing, or its pictures have another size."""
        missing = [camera.name for camera in self.cameras if camera.name not in frames.frames]
        if missing:
            return f"no picture of the camera {', '.join(missing)}"
        for name, frame in frames.frames.items():
            known = self._sizes.get(name)
            if known is not None and known.size != frame.size:
                return (
                    f"camera {name}: the picture is {frame.size[0]} x {frame.size[1]}, but those before are "
                    f"{known.size[0]} x {known.size[1]}"
                )
        return None

    def with_target(self, frames: FrameSet) -> FrameSet:
        """Return a set with the target of the shoot, read from the code of its print unless it is known."""
        if self.target is None:
            self._read_target(frames)
        return replace(frames, target=self.target)

    def _read_target(self, frames: FrameSet) -> None:
        for name, frame in frames.frames.items():
            codes = read_codes(frame.picture)
            if len(codes.prints) == 1:
                printed = codes.prints[0]
                self.target = as_printed(printed.target, self.print_scale)
                self._print_number = printed.copy
                where = f"view {len(self._views) + 1} of camera {name}"
                self.target_notes = (f"the target '{printed.name}' is read from the code in {where}",)
                return

    def add(self, frames: FrameSet, view: str) -> None:
        """Write one set; it is in the shoot when this returns, and nothing of it before.

        Raises
        ------
        OutputError
            The disk refuses.
        """
        home = self.folder.path
        make_folder(home / "images")
        devices = {camera.name: camera.device for camera in self.cameras}
        images: dict[str, str] = {}
        taken: list[TakenPicture] = []
        for name, frame in frames.frames.items():
            data = _file(frame)
            images[name] = f"images/{view}_{name}{data.suffix}"
            write_file(home / images[name], data.data, force=True)
            taken.append(
                TakenPicture(
                    view=view,
                    camera=name,
                    image=images[name],
                    device=devices[name],
                    time_s=frame.time_s,
                    exposure_us=frame.exposure_us,
                    gain=frame.gain,
                    number=frame.number,
                )
            )
            self._sizes.setdefault(name, CameraEntry(size=frame.size))
        nominal = frames.T_world_target_nominal
        self._views.append(
            ViewEntry(
                name=view,
                images=images,
                role=frames.role,
                T_world_target_nominal=None if nominal is None else matrix4_record(nominal),
            )
        )
        kept = tuple(name for name in self._record.dropped if name != view)
        pictures = (*self._record.pictures, *taken)
        self._record = self._record.model_copy(update={"pictures": pictures, "dropped": kept})
        self._write_record()
        self._write_manifest()  # last: a shoot has the views that it names
        self.folder.show()

    def drop(self, view: str) -> None:
        """Take a view out of the shoot, which is whole at every moment; its pictures are deleted.

        Raises
        ------
        OutputError
            The disk refuses.
        """
        gone = next(one for one in self._views if one.name == view)
        self._views = [one for one in self._views if one is not gone]
        if not self._views:
            self._sizes = {}
        self._write_manifest()  # first: a shoot has all pictures that it names
        pictures = tuple(one for one in self._record.pictures if one.view != view)
        dropped = (*self._record.dropped, view)
        self._record = self._record.model_copy(update={"pictures": pictures, "dropped": dropped})
        self._write_record()
        self.folder.show()
        for image in gone.images.values():
            (self.folder.path / image).unlink(missing_ok=True)

    def _write_record(self) -> None:
        text = self._record.model_dump_json(indent=1) + "\n"
        write_file(self.folder.path / RECORD, text, force=True)

    def _write_manifest(self) -> None:
        manifest = Manifest(
            target=self.target,
            print_number=self._print_number,
            cameras=self._sizes,
            views=tuple(self._views),
        )
        write_manifest(self.folder.path, manifest)


def _file(frame: Frame) -> Encoded:
    """Return a picture's file: as it came, or as PNG."""
    if frame.encoded is not None:
        return frame.encoded
    return Encoded(bytes(encoded_picture("picture.png", frame.picture)), ".png")
