"""GigE Vision and USB3 Vision cameras, through the library viva-genicam; no other file imports it."""

import time
from collections.abc import Collection
from contextlib import suppress
from types import ModuleType
from typing import TYPE_CHECKING, Any

from labcal.capture.addresses import Address
from labcal.capture.settings import SourceSettings
from labcal.capture.source import CameraInfo, Frame, FrameSet
from labcal.errors import DeviceError
from labcal.extras import optional_module
from labcal.wording import listed

if TYPE_CHECKING:
    from viva_genicam import DeviceInfo
    from viva_genicam import Frame as GenicamFrame

_SERIAL_REGISTER = 0xD8  # bootstrap register of GigE Vision: 16 bytes of text
_SERIAL_BYTES = 16
_NAME_REGISTER = 0xE8  # user-defined name, likewise
_DISCOVERY_MS = 700
_TRIES = 3
_CLOCK_S = 0.005
"""Error of the camera's clock against the computer's, s."""


class GenicamCamera:
    """One camera that speaks GenICam.

    It runs free unless it takes a software trigger. Pictures with missing packets are never handed on: the
    picture is taken again, and after :data:`_TRIES` in vain the set is refused by the device's name.

    Parameters
    ----------
    address : Address
        Its place is a serial number, a name that the user gave to the device, or an IP address.
    settings : SourceSettings
    """

    live = True

    def __init__(self, address: Address, settings: SourceSettings) -> None:
        self._address, self._settings = address, settings
        self._name = address.camera or "camera"
        self._library: ModuleType | None = None
        self._camera: Any = None
        self._stream: Any = None
        self._device = str(address)
        self._triggered = False
        self._size = (0, 0)
        self._exposure_us: float | None = None
        self._gain: float | None = None
        self._notes: list[str] = []

    def open(self) -> None:
        """Find the camera, lock its settings and start its stream.

        Raises
        ------
        DeviceError
            The library is not installed, no camera answers to the address, or it is in use.
        """
        self._library = optional_module("viva_genicam", "genicam")
        found = self._found(self._library)
        try:
            self._camera = self._library.Camera.open(found)
            self._lock()
            with suppress(self._library.GenicamError):
                self._camera.time_calibrate(4, 5)
            self._size = (self._camera.get_integer("Width"), self._camera.get_integer("Height"))
            self._stream = self._camera.stream(deliver_incomplete=True)
            self._stream.__enter__()
        except self._library.GenicamError as error:
            raise self._failed("cannot be opened", error) from error

    def describe(self) -> tuple[CameraInfo, ...]:
        """Return the camera."""
        return (
            CameraInfo(
                self._name, self._device, self._size, self._exposure_us, self._gain, tuple(self._notes)
            ),
        )

    def trigger(self) -> FrameSet:
        """Take a picture exposed after the call.

        Raises
        ------
        DeviceError
            No picture came in time, or the connection is lost.
        """
        holes: list[str] = []
        for _ in range(_TRIES):
            asked = time.time()
            frame = self._next()
            if frame.is_complete:
                when = _plausible(frame.ts_host, asked, self._exposure_us)
                picture = frame.to_numpy(demosaic=True)
                taken = Frame(picture, when, self._exposure_us, self._gain, int(frame.block_id))
                return FrameSet({self._name: taken})
            missing = frame.missing_packets
            holes.append("no end of the picture came" if missing is None else f"{missing} packets missing")
        reason = (
            f"{self._device}: {_TRIES} pictures in a row had holes ({listed(holes)}). Use a faster network "
            "card or jumbo frames, or fewer cameras on it."
        )
        return FrameSet({}, refusals=(reason,))

    def follow(self) -> FrameSet:
        """Take one more picture."""
        return self.trigger()

    def skip(self, views: Collection[str]) -> None:
        """Do nothing: the world goes on."""

    def close(self) -> None:
        """Stop the stream and give the camera back."""
        if self._library is None:
            return
        gone = (self._library.GenicamError, OSError)  # a device that was unplugged cannot be stopped
        if self._stream is not None:
            with suppress(*gone):
                self._stream.__exit__(None, None, None)
        if self._camera is not None:
            with suppress(*gone):
                self._camera.close()
        self._stream = self._camera = None

    def _next(self) -> "GenicamFrame":
        """Return the next picture that was exposed after now; it may have holes."""
        library = self._library
        if library is None or self._stream is None:
            raise RuntimeError("Call open() before trigger().")
        try:
            self._drain(library)
            if self._triggered:
                self._camera.trigger_software()
            frame: GenicamFrame | None = self._stream.next_frame(int(1000.0 * self._settings.timeout_s))
        except (library.GenicamError, TimeoutError, OSError) as error:
            raise self._failed(f"gave no picture within {self._settings.timeout_s:g} s", error) from error
        if frame is None:
            raise self._failed("ended its stream", None)
        return frame

    def _drain(self, library: ModuleType) -> None:
        """Throw away pictures that came before the trigger."""
        with suppress(library.GenicamError, TimeoutError):
            while self._stream.next_frame(1) is not None:
                pass

    def _found(self, library: ModuleType) -> "DeviceInfo":
        """Return the device that answers to the address."""
        place = self._address.place
        known: list[str] = []
        devices: list[DeviceInfo] = [*library.discover(timeout_ms=_DISCOVERY_MS, all=True), *_usb(library)]
        for device in devices:
            names = self._names(library, device)
            if place in names:
                maker = " ".join(part for part in (device.manufacturer, device.model) if part)
                self._device = f"{maker or 'camera'} {place} ({self._address})"
                return device
            known.append(" or ".join(names) or "one that is in use")
        answers = f"These answer: {listed(known)}." if known else "None answers at all."
        raise DeviceError(
            f"No GenICam camera answers to '{place}'. {answers} See that it has power and an address in the "
            "computer's network, that no firewall is between, and that no other program uses it."
        )

    def _names(self, library: ModuleType, device: "DeviceInfo") -> list[str]:
        """Return serial number, name and IP address of a device, as far as it tells them."""
        if device.transport == "u3v":
            return [name for name in (device.serial,) if name]
        names = [device.ip]
        with suppress(library.GenicamError), library.connect_gige(device, monitor=True) as camera:
            for register in (_SERIAL_REGISTER, _NAME_REGISTER):
                text = camera.read_register(register, _SERIAL_BYTES)
                names.insert(0, text.split(b"\0")[0].decode("utf-8", "replace").strip())
        return [name for name in dict.fromkeys(names) if name]

    def _lock(self) -> None:
        """Switch automatic exposure and gain off, set what is asked for, and read what holds."""
        library, camera, wanted = self._library, self._camera, self._settings
        if library is None:
            raise RuntimeError("Call open() first.")
        for feature in ("ExposureAuto", "GainAuto", "BalanceWhiteAuto"):
            with suppress(library.GenicamError):
                camera.set_enum(feature, "Off")
        for what, value, setter in (
            ("exposure", wanted.exposure_us, camera.set_exposure_time),
            ("gain", wanted.gain, camera.set_gain),
        ):
            if value is not None:
                try:
                    setter(value)
                except library.GenicamError as error:
                    self._notes.append(f"{self._name}: the {what} could not be set ({error})")
        try:
            camera.enable_trigger("FrameStart", "Software")
            self._triggered = True
        except library.GenicamError:
            self._notes.append(f"{self._name}: takes no software trigger, so it runs free")
        with suppress(library.GenicamError):
            self._exposure_us = float(camera.exposure_time())
        with suppress(library.GenicamError):
            self._gain = float(camera.gain())

    def _failed(self, what: str, error: BaseException | None) -> DeviceError:
        because = "" if error is None else f": {error}"
        return DeviceError(
            f"The camera {self._device} {what}{because}. See that it has power "
            "and that its cable is plugged in."
        )


def _plausible(stated_s: float | None, asked_s: float, exposure_us: float | None) -> float:
    """Return when a picture was taken: by the camera's clock, or now where that cannot be.

    A clock that was not set against the computer's, or that stands still, states times before the call.
    """
    now = time.time()
    earliest = asked_s - _CLOCK_S - 1e-6 * (exposure_us or 0.0)
    return now if stated_s is None or not earliest <= stated_s <= now + _CLOCK_S else float(stated_s)


def _usb(library: ModuleType) -> list[Any]:
    """Return USB3 Vision cameras; none where the system lets no program look."""
    try:
        return list(library.discover_u3v())
    except library.GenicamError:
        return []


def source_of(address: Address, settings: SourceSettings) -> GenicamCamera:
    """Return the source of a GenICam camera."""
    return GenicamCamera(address, settings)
