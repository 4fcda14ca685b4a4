"""Live cameras, and a person at the live page, for tests."""

import time
from collections.abc import Collection, Mapping

import numpy as np

from labcal.capture.source import CameraInfo, Frame, FrameSet
from labcal.errors import DeviceError


class LiveCameras:
    """Cameras that see the pictures of a list in turn, each time a copy of one.

    Parameters
    ----------
    scenes : mapping of str to list of ndarray
        What each camera sees; the lists are as long as each other.
    """

    live = True

    def __init__(self, scenes: Mapping[str, list[np.ndarray]], exposure_us: float = 2000.0) -> None:
        self.scenes, self.exposure_us = dict(scenes), exposure_us
        self.at, self.taken = 0, 0
        self.turning = True
        self.unplugged = False

    def open(self) -> None:
        self.at = 0

    def describe(self) -> tuple[CameraInfo, ...]:
        return tuple(
            CameraInfo(name, f"stand-in {name}", pictures[0].shape[1::-1])
            for name, pictures in self.scenes.items()
        )

    def trigger(self) -> FrameSet:
        if self.unplugged:
            raise DeviceError("The camera left was unplugged.")
        self.taken += 1
        count = len(next(iter(self.scenes.values())))
        frames = {
            name: Frame(pictures[self.at % count].copy(), time.time(), self.exposure_us)
            for name, pictures in self.scenes.items()
        }
        now = time.time()
        frames = {name: Frame(one.picture, now, one.exposure_us) for name, one in frames.items()}
        self.at += self.turning
        return FrameSet(frames)

    def follow(self) -> FrameSet:
        return self.trigger()

    def skip(self, views: Collection[str]) -> None:
        pass

    def close(self) -> None:
        pass
