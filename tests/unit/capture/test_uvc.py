"""Webcams by a stand-in for OpenCV's class: no webcam was at hand."""

import time

import cv2
import numpy as np
import pytest

from labcal.capture.addresses import Address
from labcal.capture.settings import SourceSettings
from labcal.capture.source import opened
from labcal.capture.uvc import Webcam
from labcal.errors import DeviceError, InputError

PERIOD_S = 0.02


class VideoCapture:
    """A webcam of 50 pictures a second whose driver keeps four; a picture tells when it was taken."""

    plugged = True
    manual = True

    def __init__(self, number: int) -> None:
        self.number, self.began, self.given = number, time.monotonic(), 0
        self.set_values: dict[int, float] = {}
        self.released = False

    def isOpened(self) -> bool:
        return self.number == 0

    def getBackendName(self) -> str:
        return "STAND-IN"

    def get(self, key: int) -> float:
        return {cv2.CAP_PROP_FPS: 1.0 / PERIOD_S, **self.set_values}.get(key, -1.0)

    def set(self, key: int, value: float) -> bool:
        if key == cv2.CAP_PROP_EXPOSURE and not self.manual:
            return False
        self.set_values[key] = value
        return True

    def grab(self) -> bool:
        newest = int((time.monotonic() - self.began) / PERIOD_S)
        self.given = max(self.given + 1, newest - 3)
        time.sleep(max(0.0, self.given * PERIOD_S - (time.monotonic() - self.began)))
        return self.plugged

    def read(self) -> tuple[bool, np.ndarray | None]:
        done = self.grab()
        return done, np.full((24, 32, 3), (1, 2, self.given % 250), np.uint8) if done else None

    def release(self) -> None:
        self.released = True


@pytest.fixture(autouse=True)
def stand_in(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(cv2, "VideoCapture", VideoCapture)


def webcam(place: str = "0", settings: SourceSettings | None = None) -> Webcam:
    return Webcam(Address("uvc", place, "left"), SourceSettings() if settings is None else settings)


def test_the_picture_was_exposed_after_the_call_and_is_red_first() -> None:
    with opened(webcam()) as source:
        time.sleep(6 * PERIOD_S)  # the driver's buffer is full of old pictures
        began = source._capture.began  # type: ignore[attr-defined]
        asked = (time.monotonic() - began) / PERIOD_S
        taken = source.trigger()
        assert taken is not None
        frame = taken.frames["left"]
        assert frame.picture[0, 0].tolist()[1:] == [2, 1]
        assert frame.picture[0, 0, 0] >= asked
        assert frame.time_s == pytest.approx(time.time(), abs=0.1)


def test_exposure_is_locked_where_the_device_allows_it_and_noted_where_not(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    wanted = SourceSettings(exposure_us=5000.0, gain=3.0)
    with opened(webcam(settings=wanted)) as source:
        (info,) = source.describe()
    assert (info.exposure_us, info.gain, info.notes) == (5000.0, 3.0, ())
    monkeypatch.setattr(VideoCapture, "manual", False)
    with opened(webcam(settings=wanted)) as source:
        (info,) = source.describe()
    assert info.notes == ("left: the exposure could not be locked; see that it does not change",)


def test_a_webcam_that_is_missing_or_unplugged_is_named(monkeypatch: pytest.MonkeyPatch) -> None:
    with pytest.raises(DeviceError, match="uvc:3"), opened(webcam("3")):
        pass
    with opened(webcam()) as source:
        monkeypatch.setattr(VideoCapture, "plugged", False)
        with pytest.raises(DeviceError, match=r"uvc:0.*plugged in"):
            source.trigger()
    with pytest.raises(InputError, match="by its number"):
        webcam("front")
