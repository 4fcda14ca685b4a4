"""One thread for OpenCV, whose calibration forms sums in the order in which its threads end."""

from collections.abc import Iterator
from contextlib import contextmanager

import cv2


@contextmanager
def one_opencv_thread() -> Iterator[None]:
    """Let OpenCV compute with one thread inside, and with as many as before afterwards.

    With more, the same points give other last digits at every run.
    """
    before = cv2.getNumThreads()
    cv2.setNumThreads(1)
    try:
        yield
    finally:
        cv2.setNumThreads(before)
