"""Pictures that are in a folder already, replayed in the order of their names."""

from collections.abc import Collection, Iterator
from itertools import groupby
from pathlib import Path

from labcal.arrays import Pose
from labcal.capture.addresses import Address
from labcal.capture.settings import SourceSettings
from labcal.capture.source import CameraInfo, Encoded, Frame, FrameSet
from labcal.correspond.one_camera import doubts
from labcal.correspond.picture_set import PictureSet, open_pictures
from labcal.correspond.sources import Source as Picture
from labcal.errors import InputError
from labcal.run.file_reading import read_bytes
from labcal.shoot.manifest import Role
from labcal.shoot.pictures import MOST_BYTES
from labcal.wording import listed


class FolderSource:
    """The pictures of a folder or of a shoot; a view is one set.

    Parameters
    ----------
    address : Address
        Its place is the folder.
    cameras : str, optional
        Cameras by the end of the names, as of :func:`~labcal.correspond.picture_set.open_pictures`.
    raw : str, optional
        Pixel format, as of the same.
    """

    live = False

    def __init__(self, address: Address, cameras: str | None, raw: str | None = None) -> None:
        self._address, self._cameras, self._raw = address, cameras, raw
        self._infos: tuple[CameraInfo, ...] = ()
        self._poses: dict[str, Pose] = {}
        self._roles: dict[str, str] = {}
        self._sets: Iterator[tuple[str, list[Picture]]] = iter(())

    def open(self) -> None:
        """Find the pictures, and read the first one of each camera for its size.

        Raises
        ------
        InputError
            There are none; they are of several cameras, and the address names one; or they may be of several,
            and neither it nor `cameras` says so: a shoot that is made stays so.
        """
        found = open_pictures(self._address.place, self._cameras, self._raw)
        self._poses = {} if found.shoot is None else found.shoot.nominal_poses()
        self._roles = found.roles
        cameras = list(dict.fromkeys(one.camera for one in found.sources))
        if len(cameras) > 1 and self._address.camera is not None:
            raise InputError(
                f"{self._address} has pictures of {listed(cameras)}, but as '{self._address.camera}' they "
                "would be of one camera. Give it alone, without a name, or a folder for each camera."
            )
        stated = self._cameras is not None or self._address.camera is not None or found.shoot is not None
        doubt = None if stated else doubts([one.image for one in found.sources])
        if doubt is not None:
            raise InputError(doubt)
        self._infos = tuple(self._info(camera, found) for camera in cameras)
        self._sets = iter(
            [(view, list(pictures)) for view, pictures in groupby(found.sources, lambda one: one.view)]
        )

    def describe(self) -> tuple[CameraInfo, ...]:
        """Return the cameras that the names tell of."""
        return self._infos

    def trigger(self) -> FrameSet | None:
        """Return the pictures of the next view; one that cannot be read is a reason to refuse the set."""
        following = next(self._sets, None)
        if following is None:
            return None
        view, pictures = following
        frames: dict[str, Frame] = {}
        refusals: list[str] = []
        for picture in pictures:
            try:
                frames[self._name(picture.camera)] = frame_of(picture)
            except InputError as error:  # a damaged file
                refusals.append(str(error))
        role = Role(self._roles.get(view, Role.TRAIN))
        return FrameSet(frames, view, self._poses.get(view), role, tuple(refusals))

    def follow(self) -> None:
        """Return nothing: these are stills."""

    def skip(self, views: Collection[str]) -> None:
        """Leave out the pictures of these views."""
        self._sets = iter([one for one in self._sets if one[0] not in views])

    def close(self) -> None:
        """Forget the pictures."""
        self._sets = iter(())

    def _name(self, camera: str) -> str:
        """Return the name of a camera, which that of the address replaces where there is one only."""
        return camera if self._address.camera is None else self._address.camera

    def _info(self, camera: str, found: PictureSet) -> CameraInfo:
        first = next(one for one in found.sources if one.camera == camera)
        picture = first.read()
        return CameraInfo(
            self._name(camera), str(self._address), (int(picture.shape[1]), int(picture.shape[0]))
        )


def frame_of(picture: Picture) -> Frame:
    """Return a picture as it was measured, with its file as it is, except where that does not tell its form.

    Raises
    ------
    InputError
        It cannot be read.
    """
    encoded = file_of(Path(picture.image)) if picture.raw is None else None
    return Frame(picture.read(), encoded=encoded)


def file_of(path: Path) -> Encoded:
    """Return a picture's file as it is."""
    return Encoded(read_bytes(path, "picture", MOST_BYTES), path.suffix.lower())


def source_of(address: Address, settings: SourceSettings) -> FolderSource:
    """Return the source of a folder, which is looked at when it is opened."""
    return FolderSource(address, settings.cameras, settings.raw)
