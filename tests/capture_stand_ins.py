"""Sources that take what a test wants."""

from collections.abc import Collection, Sequence

import numpy as np

from labcal.capture.source import CameraInfo, Frame, FrameSet
from labcal.errors import DeviceError

SIZE = (32, 24)


def picture(value: int = 0, size: tuple[int, int] = SIZE) -> np.ndarray:
    return np.full(size[::-1], value, np.uint8)


def frame_set(*cameras: str, skew_s: float = 0.0, refusals: tuple[str, ...] = ()) -> FrameSet:
    """Return a set of one grey picture a camera, each later than the one before."""
    frames = {name: Frame(picture(k), 100.0 + k * skew_s) for k, name in enumerate(cameras)}
    return FrameSet(frames, refusals=refusals)


class StandIn:
    """A source that gives the sets of a list, and notes how it is used."""

    def __init__(
        self,
        sets: Sequence[FrameSet | DeviceError],
        cameras: Sequence[str] = ("left", "right"),
        *,
        live: bool = False,
    ) -> None:
        self.live, self.sets, self.cameras = live, list(sets), tuple(cameras)
        self.called: list[str] = []

    def open(self) -> None:
        self.called.append("open")

    def describe(self) -> tuple[CameraInfo, ...]:
        return tuple(
            CameraInfo(name, f"stand-in {name}", SIZE, notes=(f"{name} is a stand-in",))
            for name in self.cameras
        )

    def trigger(self) -> FrameSet | None:
        if not self.sets:
            return None
        following = self.sets.pop(0)
        if isinstance(following, DeviceError):
            raise following
        return following

    def follow(self) -> FrameSet | None:
        return None

    def skip(self, views: Collection[str]) -> None:
        self.called.append(f"skip {sorted(views)}")

    def close(self) -> None:
        self.called.append("close")
