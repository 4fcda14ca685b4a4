"""Webcams and other cameras that the system offers, through OpenCV's VideoCapture."""

import time
from collections.abc import Collection
from typing import Any

import cv2
import numpy as np

from labcal.capture.addresses import Address
from labcal.capture.settings import SourceSettings
from labcal.capture.source import CameraInfo, Frame, FrameSet
from labcal.errors import DeviceError, InputError
from labcal.shoot.pictures import red_first

_MANUAL = 1.0  # of V4L2: 1 manual, 3 aperture priority
_MICROSECONDS = 100.0  # V4L2 states exposure in units of 100 microseconds
_MOST_STALE = 10


class Webcam:
    """One webcam.

    OpenCV keeps pictures that came before they were asked for: `trigger` throws them away, so that its
    picture was exposed after the call.

    Parameters
    ----------
    address : Address
        Its place is the camera's number.
    settings : SourceSettings
    """

    live = True

    def __init__(self, address: Address, settings: SourceSettings) -> None:
        if not address.place.isdecimal():
            raise InputError(
                f"A webcam is named by its number, as in uvc:0, but uvc:{address.place} was given."
            )
        self._address, self._settings = address, settings
        self._name = address.camera or "camera"
        self._capture: Any = None
        self._size = (0, 0)
        self._notes: list[str] = []
        self._number = 0

    def open(self) -> None:
        """Open the device, lock what is asked for, and take a first picture for its size.

        Raises
        ------
        DeviceError
            There is no such webcam, or it gives no picture.
        """
        self._capture = cv2.VideoCapture(int(self._address.place))
        if not self._capture.isOpened():
            raise DeviceError(
                f"There is no webcam {self._address}, or another program uses it. Plug it in, close the "
                "other program, or try another number."
            )
        self._capture.set(cv2.CAP_PROP_BUFFERSIZE, 1)
        self._lock()
        first = self._read()
        self._size = (int(first.shape[1]), int(first.shape[0]))

    def describe(self) -> tuple[CameraInfo, ...]:
        """Return the camera."""
        backend = self._capture.getBackendName()
        return (
            CameraInfo(
                self._name,
                f"{self._address} ({backend})",
                self._size,
                self._exposure(),
                self._value(cv2.CAP_PROP_GAIN),
                tuple(self._notes),
            ),
        )

    def trigger(self) -> FrameSet:
        """Take a picture that was exposed after the call.

        Raises
        ------
        DeviceError
            The webcam was unplugged or gives no picture.
        """
        self._drain()
        picture = self._read()
        now = time.time()
        self._number += 1
        gain = self._value(cv2.CAP_PROP_GAIN)
        return FrameSet({self._name: Frame(picture, now, self._exposure(), gain, self._number)})

    def follow(self) -> FrameSet:
        """Take one more picture."""
        return self.trigger()

    def skip(self, views: Collection[str]) -> None:
        """Do nothing: the world goes on."""

    def close(self) -> None:
        """Give the device back."""
        if self._capture is not None:
            self._capture.release()
            self._capture = None

    def _read(self) -> np.ndarray:
        """Return the next picture, red first."""
        done, picture = self._capture.read()
        if not done or picture is None:
            raise self._silent()
        return red_first(picture)

    def _drain(self) -> None:
        """Throw away pictures that are ready at once, and the one that is being exposed."""
        rate = self._capture.get(cv2.CAP_PROP_FPS)
        period = 1.0 / rate if rate > 0.0 else 1.0 / 30.0
        for _ in range(_MOST_STALE):
            began = time.monotonic()
            if not self._capture.grab():
                raise self._silent()
            if time.monotonic() - began > 0.5 * period:
                return

    def _lock(self) -> None:
        """Set exposure and gain by hand where asked for; note what the device refuses."""
        wanted = self._settings
        self._set(cv2.CAP_PROP_AUTOFOCUS, 0.0, "focus")
        self._set(cv2.CAP_PROP_AUTO_EXPOSURE, _MANUAL, "automatic exposure")
        if wanted.exposure_us is not None:
            self._set(cv2.CAP_PROP_EXPOSURE, wanted.exposure_us / _MICROSECONDS, "exposure")
        if wanted.gain is not None:
            self._set(cv2.CAP_PROP_GAIN, wanted.gain, "gain")

    def _silent(self) -> DeviceError:
        return DeviceError(
            f"The webcam {self._address} gives no picture. See whether it is still plugged in."
        )

    def _set(self, key: int, value: float, name: str) -> None:
        """Set a property; note it by its name where the device refuses."""
        if not self._capture.set(key, value):
            self._notes.append(f"{self._name}: the {name} could not be locked; see that it does not change")

    def _exposure(self) -> float | None:
        value = self._value(cv2.CAP_PROP_EXPOSURE)
        return None if value is None or value < 0.0 else _MICROSECONDS * value

    def _value(self, key: int) -> float | None:
        value = float(self._capture.get(key))
        return value if np.isfinite(value) and value != -1.0 else None


def source_of(address: Address, settings: SourceSettings) -> Webcam:
    """Return the source of a webcam."""
    return Webcam(address, settings)
