"""The interface of a source of pictures, and the data that pass through it."""

from collections.abc import Collection, Iterator, Mapping
from contextlib import contextmanager
from dataclasses import dataclass
from typing import Protocol, runtime_checkable

import numpy as np
from jaxtyping import Shaped

from labcal.arrays import Pose
from labcal.detect.dots import PictureDots
from labcal.shoot.manifest import Role
from labcal.targets.catalogue import AnyTarget


@dataclass(frozen=True)
class CameraInfo:
    """A camera of a source, as far as it tells."""

    name: str
    """Name in the shoot: letters, digits and hyphens."""
    device: str
    """The device in its own words: maker, model, serial number; the address where it tells nothing."""
    size: tuple[int, int]
    """Width and height of its pictures, px."""
    exposure_us: float | None = None
    """Exposure time, microseconds."""
    gain: float | None = None
    """Gain, in the unit that the device has (most often dB)."""
    notes: tuple[str, ...] = ()
    """Settings that could not be read, set or locked, for people."""


@dataclass(frozen=True)
class Encoded:
    """The bytes of a picture's file."""

    data: bytes
    """All of them."""
    suffix: str
    """Ending of the file's name, with the dot: ``.jpg``."""


@dataclass(frozen=True)
class Frame:
    """One picture of one camera."""

    picture: Shaped[np.ndarray, "*shape"]
    """(height, width) or (height, width, 3) in the order red, green, blue; uint8 or uint16."""
    time_s: float | None = None
    """Time of exposure: seconds since 1970 of the computer's clock, or since the beginning of a recording;
    None where nothing tells."""
    exposure_us: float | None = None
    """Exposure time, microseconds."""
    gain: float | None = None
    """Gain, in the device's unit."""
    number: int | None = None
    """Number that the device or the recording gives the picture."""
    encoded: "Encoded | None" = None
    """The picture's file, where it came as one, so that it enters the shoot unchanged."""
    dots: PictureDots | None = None
    """Dots of the target that were found in it already; None where nobody has looked."""

    @property
    def size(self) -> tuple[int, int]:
        """Width and height, px."""
        return int(self.picture.shape[1]), int(self.picture.shape[0])


@dataclass(frozen=True)
class FrameSet:
    """Pictures of one moment, of some or all cameras of a source."""

    frames: Mapping[str, Frame]
    """Picture by camera."""
    view: str | None = None
    """Name of the view where the source has one."""
    T_world_target_nominal: Pose | None = None
    """Pose that a stage states, (4, 4), mm."""
    role: Role = Role.TRAIN
    """Use of the view."""
    refusals: tuple[str, ...] = ()
    """Reasons why these pictures may not enter a shoot, each naming its device; empty for good ones."""
    target: AnyTarget | None = None
    """Target of the shoot that these pictures entered; None where it is not known yet."""

    @property
    def skew_s(self) -> float | None:
        """Time between the first and the last picture, s; None where less than two have a time."""
        times = [frame.time_s for frame in self.frames.values() if frame.time_s is not None]
        return max(times) - min(times) if len(times) > 1 else None


@runtime_checkable  # so that tests can check annotations
class Source(Protocol):
    """Cameras that take pictures together.

    The order of calls is `open`, `describe` and `trigger` as often as wanted, `close`. A source is closed
    also where `open` failed half-way.
    """

    live: bool
    """True where the world goes on between two triggers, as for a real camera; False for a recording."""

    def open(self) -> None:
        """Connect to the devices.

        Raises
        ------
        DeviceError
            A device is not there, is in use, or does not answer.
        InputError
            The address cannot be used.
        """

    def describe(self) -> tuple[CameraInfo, ...]:
        """Return the cameras, in order; only between `open` and `close`."""

    def trigger(self) -> FrameSet | None:
        """Take one set of pictures.

        Returns
        -------
        FrameSet or None
            None where there are no more.

        Raises
        ------
        DeviceError
            A camera was unplugged, or gave no picture in time; the message names it.
        """

    def follow(self) -> FrameSet | None:
        """Take a set right after the last one, to judge motion; None where a source has stills only.

        Raises
        ------
        DeviceError
            As of :meth:`trigger`.
        """

    def skip(self, views: Collection[str]) -> None:
        """Leave out views that a shoot has already; a live camera does nothing."""

    def close(self) -> None:
        """Give the devices back; may be called twice."""


@runtime_checkable
class Waiting(Protocol):
    """A source whose pictures another program delivers when it likes."""

    waits: bool
    """True."""

    def peek(self) -> FrameSet:
        """Return the set that comes next without waiting for it; without frames where there is none yet."""


@contextmanager
def opened(source: Source) -> Iterator[Source]:
    """Open a source for the length of a block."""
    try:
        source.open()
        yield source
    finally:
        source.close()
