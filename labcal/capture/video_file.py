"""Frames of a video file, one after another."""

from collections.abc import Iterator
from pathlib import Path

import cv2
import numpy as np

from labcal.errors import InputError
from labcal.shoot.pictures import red_first

_LEAST_RATE, _MOST_RATE = 0.1, 10000.0


class VideoFile:
    """A video file.

    Parameters
    ----------
    path : Path

    Raises
    ------
    InputError
        It is no video that OpenCV can read, or does not tell its frame rate.
    """

    def __init__(self, path: Path) -> None:
        self.path = path
        if not path.is_file():
            raise InputError(f"There is no video {path}.")
        reader = self._reader()
        self.rate = float(reader.get(cv2.CAP_PROP_FPS))
        self.stated_frames = max(0, int(reader.get(cv2.CAP_PROP_FRAME_COUNT)))
        """Number of frames by its header, which may be wrong; 0 where it does not tell."""
        done, first = reader.read()
        reader.release()
        if not done or first is None:
            raise InputError(f"{path} is not a video that can be read. Convert it to MP4 or AVI.")
        if not _LEAST_RATE <= self.rate <= _MOST_RATE:
            raise InputError(f"The video {path} does not tell its frame rate. Write it again with one.")
        self.size = (int(first.shape[1]), int(first.shape[0]))

    def frames(self) -> Iterator[np.ndarray]:
        """Yield the frames: (height, width, 3), red first, uint8."""
        reader = self._reader()
        try:
            while True:
                done, picture = reader.read()
                if not done or picture is None:
                    return
                yield red_first(picture)
        finally:
            reader.release()

    def _reader(self) -> cv2.VideoCapture:
        reader = cv2.VideoCapture(str(self.path))
        reader.set(cv2.CAP_PROP_ORIENTATION_AUTO, 0.0)  # the pixels as the sensor stored them
        return reader
