"""Pictures that another program drops into a folder, such as one that tethers a still camera."""

import time
from collections.abc import Collection
from dataclasses import replace
from pathlib import Path

from labcal.capture.addresses import Address
from labcal.capture.folder import frame_of
from labcal.capture.settings import SourceSettings
from labcal.capture.source import CameraInfo, Frame, FrameSet
from labcal.correspond.name_patterns import CAMERA
from labcal.correspond.sources import Source as Picture
from labcal.correspond.sources import camera_endings, loose_source
from labcal.errors import DeviceError, InputError
from labcal.shoot.pictures import SUFFIXES
from labcal.shoot.raw_pictures import RAW_SUFFIXES, parse_raw_format
from labcal.wording import listed

POLL_S = 0.05
"""Time between two looks at the folder."""
SETTLED_S = 0.25
"""A file that has not changed for so long is read."""


class WatchedFolder:
    """A folder whose new pictures are taken as they appear; a view is whole when each camera has its picture.

    A file that is being written is waited for: it is read when its size and time have stood still, and read
    again until it is a whole picture. Files that are in the folder when it is opened are left alone.

    Parameters
    ----------
    address : Address
        Its place is the folder.
    settings : SourceSettings
        Names of the cameras, and how long to wait.
    """

    live = False  # the other program sets the pace
    waits = True
    """True: pictures come when another program delivers them, and nothing is known beforehand."""

    def __init__(self, address: Address, settings: SourceSettings) -> None:
        self._address, self._folder = address, Path(address.place)
        self._timeout_s = settings.timeout_s
        self._raw = None if settings.raw is None else parse_raw_format(settings.raw)
        self._endings = {} if settings.cameras is None else camera_endings(settings.cameras)
        if CAMERA in self._endings.values():
            raise InputError(
                "A watched folder must be told which cameras it waits for: `cameras='_0=left,_1=right'`, not "
                f"a pattern with {CAMERA}."
            )
        self._names = list(dict.fromkeys(self._endings.values())) or [address.camera or "camera"]
        self._known: set[Path] = set()
        self._stood: dict[Path, tuple[tuple[int, int], float]] = {}
        self._waiting: dict[str, dict[str, tuple[Picture, Frame]]] = {}
        self._sizes: dict[str, tuple[int, int]] = {}
        self._changed_s = time.monotonic()

    def open(self) -> None:
        """Look at what is in the folder now.

        Raises
        ------
        InputError
            It is no folder.
        """
        if not self._folder.is_dir():
            raise InputError(f"There is no folder {self._folder} to watch. Create it, or correct the name.")
        self._known = set(self._pictures())
        self._changed_s = time.monotonic()

    def describe(self) -> tuple[CameraInfo, ...]:
        """Return the cameras; their sizes are (0, 0) until each has its first picture."""
        return tuple(
            CameraInfo(name, str(self._address), self._sizes.get(name, (0, 0))) for name in self._names
        )

    def trigger(self) -> FrameSet | None:
        """Wait for the next view to be whole.

        Raises
        ------
        DeviceError
            No new file appeared for the longest wait; views whose pictures are missing are named.
        """
        self._changed_s = time.monotonic()
        while not self._is_late():
            ready = self.peek()
            if ready.view is not None:
                del self._waiting[ready.view]
                return ready
            time.sleep(POLL_S)
        raise DeviceError(self._silence())

    def peek(self) -> FrameSet:
        """Return the view that comes next, without waiting for it.

        Returns
        -------
        FrameSet
            No frames where no view is whole yet; then with the reason, once no file appeared for the longest
            wait.
        """
        if self._look():
            self._changed_s = time.monotonic()
        ready = next((view for view, got in self._waiting.items() if len(got) == len(self._names)), None)
        if ready is None:
            return FrameSet({}, refusals=(self._silence(),) if self._is_late() else ())
        got = self._waiting[ready]
        return FrameSet({name: got[name][1] for name in self._names}, ready)

    def _is_late(self) -> bool:
        return time.monotonic() - self._changed_s > self._timeout_s

    def follow(self) -> None:
        """Return nothing: these are stills."""

    def skip(self, views: Collection[str]) -> None:
        """Do nothing: what is in the folder already is not taken."""

    def close(self) -> None:
        """Forget what was seen."""
        self._waiting.clear()
        self._stood.clear()

    def _pictures(self) -> list[Path]:
        suffixes = SUFFIXES if self._raw is None else SUFFIXES | RAW_SUFFIXES
        return sorted(path for path in self._folder.iterdir() if path.suffix.lower() in suffixes)

    def _look(self) -> bool:
        """Read files that have stood still, and return whether anything changed."""
        changed = False
        for path in self._pictures():
            if path in self._known:
                continue
            try:
                status = path.stat()
            except OSError:  # renamed or removed meanwhile
                continue
            now, state = time.monotonic(), (status.st_size, status.st_mtime_ns)
            before = self._stood.get(path)
            if before is None or before[0] != state:
                self._stood[path] = (state, now)
                changed = True
            elif now - before[1] >= SETTLED_S and self._take(path):
                self._known.add(path)
                changed = True
        return changed

    def _take(self, path: Path) -> bool:
        """Read a file into its view; return whether it was a whole picture.

        The frame has no time: that of a file tells when it was copied, not when the picture was exposed.
        """
        source = replace(loose_source(str(path), self._endings), raw=self._raw)
        name = self._names[0] if not self._endings else source.camera
        try:
            frame = frame_of(source)
        except InputError:  # half-written still
            return False
        self._sizes.setdefault(name, frame.size)
        self._waiting.setdefault(source.view, {})[name] = (source, frame)
        return True

    def _silence(self) -> str:
        """Return the message for a wait that was in vain."""
        halves = [path.name for path in self._stood if path not in self._known]
        missing = [
            f"{view}: {listed([name for name in self._names if name not in got])}"
            for view, got in self._waiting.items()
        ]
        parts = [f"No new picture came into {self._folder} for {self._timeout_s:g} s."]
        if halves:
            parts.append(f"Not whole: {listed(halves)}.")
        if missing:
            parts.append(f"Views that still lack a camera: {listed(missing)}.")
        parts.append("See whether the program that writes them is at work, or give a longer `timeout_s`.")
        return " ".join(parts)


def source_of(address: Address, settings: SourceSettings) -> WatchedFolder:
    """Return the source of a watched folder."""
    return WatchedFolder(address, settings)
