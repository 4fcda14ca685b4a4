"""Video files replayed as cameras: one, or several with an offset in time between them."""

from collections.abc import Collection, Iterator, Sequence
from dataclasses import dataclass
from pathlib import Path

import numpy as np

from labcal.capture.addresses import Address
from labcal.capture.settings import SourceSettings
from labcal.capture.source import CameraInfo, Frame, FrameSet
from labcal.capture.video_file import VideoFile
from labcal.capture.video_offset import offset_frames
from labcal.errors import InputError
from labcal.run.progress import Progress
from labcal.shoot.quality import picture_quality
from labcal.targets.catalogue import AnyTarget

WINDOW_S = 1.0
"""Of each so many seconds the sharpest frames are taken, unless every n-th is asked for."""


@dataclass(frozen=True)
class Moment:
    """The frames of one moment in all videos."""

    numbers: tuple[int, ...]
    """Number of the frame by video."""
    pictures: tuple[np.ndarray, ...]
    """Picture by video."""


class Videos:
    """Videos of one event.

    Parameters
    ----------
    addresses : sequence of Address
        Their places are the files.
    offsets : sequence of float
        By video, how many of its frames a moment comes later in it than in the first one; 0 for that itself.
    every : int, optional
        Take one frame in so many of the first video; the sharpest of each second where left out.
    """

    live = False

    def __init__(self, addresses: Sequence[Address], offsets: Sequence[float], every: int | None) -> None:
        self._addresses, self._offsets, self._every = tuple(addresses), tuple(offsets), every
        self._files: tuple[VideoFile, ...] = ()
        self._chosen: Iterator[tuple[Moment, Moment | None]] = iter(())
        self._after: Moment | None = None

    def open(self) -> None:
        """Open the files.

        Raises
        ------
        InputError
            One is no video that can be read.
        """
        self._files = tuple(VideoFile(Path(address.place)) for address in self._addresses)
        self._chosen = self._sharpest() if self._every is None else self._regular(self._every)

    def describe(self) -> tuple[CameraInfo, ...]:
        """Return one camera for each video."""
        names = self._names()
        return tuple(
            CameraInfo(name, str(address), file.size)
            for name, address, file in zip(names, self._addresses, self._files, strict=True)
        )

    def trigger(self) -> FrameSet | None:
        """Return the next moment; its view is named after the frame of the first video."""
        following = next(self._chosen, None)
        if following is None:
            return None
        moment, self._after = following
        return self._set(moment)

    def follow(self) -> FrameSet | None:
        """Return the frames right after the last moment."""
        return None if self._after is None else self._set(self._after)

    def skip(self, views: Collection[str]) -> None:
        """Leave out moments that have these names."""
        self._chosen = (pair for pair in self._chosen if _view(pair[0]) not in views)

    def close(self) -> None:
        """Close the files."""
        self._chosen = iter(())

    def _names(self) -> list[str]:
        return [address.camera or "camera" for address in self._addresses]

    def _set(self, moment: Moment) -> FrameSet:
        frames = {}
        for k, name in enumerate(self._names()):
            time_s = (moment.numbers[k] - self._offsets[k]) / self._files[k].rate
            frames[name] = Frame(moment.pictures[k], time_s, number=moment.numbers[k])
        return FrameSet(frames, _view(moment))

    def _moments(self) -> Iterator[Moment]:
        """Yield every frame of the first video with the nearest ones of the others."""
        readers = [_Numbered(file) for file in self._files]
        rate = self._files[0].rate
        for number, picture in enumerate(self._files[0].frames()):
            seconds = number / rate
            numbers = [number]
            pictures = [picture]
            for k in range(1, len(readers)):
                wanted = round(seconds * self._files[k].rate + self._offsets[k])
                found = readers[k].frame(wanted)
                if found is None:
                    break
                numbers.append(wanted)
                pictures.append(found)
            else:
                yield Moment(tuple(numbers), tuple(pictures))

    def _regular(self, every: int) -> Iterator[tuple[Moment, Moment | None]]:
        """Yield one moment in so many, with the one after it."""
        chosen: Moment | None = None
        for moment in self._moments():
            if chosen is not None:
                yield chosen, moment
            chosen = moment if moment.numbers[0] % every == 0 else None
        if chosen is not None:
            yield chosen, None

    def _sharpest(self) -> Iterator[tuple[Moment, Moment | None]]:
        """Yield the sharpest moment of each second, with the one after it."""
        best: Moment | None = None
        after: Moment | None = None
        window, score, fresh = -1, -np.inf, False
        for moment in self._moments():
            if fresh:
                after, fresh = moment, False
            now = int(moment.numbers[0] / (self._files[0].rate * WINDOW_S))
            if now != window:
                if best is not None:
                    yield best, after
                window, score, best = now, -np.inf, None
            sharpness = min(_sharpness(picture) for picture in moment.pictures)
            if sharpness > score:
                best, score, after, fresh = moment, sharpness, None, True
        if best is not None:
            yield best, after


class _Numbered:
    """The frames of a video by number, asked for in rising order."""

    def __init__(self, file: VideoFile) -> None:
        self._frames, self._number = file.frames(), -1
        self._last: np.ndarray | None = None

    def frame(self, number: int) -> np.ndarray | None:
        """Return a frame; None before the first and after the last."""
        while self._number < number:
            self._last = next(self._frames, None)
            self._number += 1
            if self._last is None:
                return None
        return self._last if self._number == number else None


def _view(moment: Moment) -> str:
    return f"frame-{moment.numbers[0]:06d}"


def _sharpness(picture: np.ndarray) -> float:
    """Return the sharpness of a picture, 1/px; -1 where there are no edges."""
    sharpness = picture_quality(picture).sharpness
    return sharpness if np.isfinite(sharpness) else -1.0


def source_of(address: Address, settings: SourceSettings) -> Videos:
    """Return the source of one video."""
    return Videos([address], [0.0], settings.every)


def videos_together(
    addresses: Sequence[Address],
    target: AnyTarget | None,
    settings: SourceSettings,
    progress: Progress | None = None,
) -> Videos:
    """Return several videos as the cameras of one rig, with the offsets between them.

    Parameters
    ----------
    addresses : sequence of Address
    target : AnyTarget or None
        The target by whose motion offsets are estimated.
    settings : SourceSettings
        With the offset of the second video, where it is known.
    progress : Progress, optional
        Of the estimation of offsets.

    Raises
    ------
    InputError
        An offset is given for more than two videos; or none is given, and there is no target, or its motion
        does not tell.
    """
    if settings.video_offset is not None:
        if len(addresses) != 2:  # noqa: PLR2004 -- the one that has an offset, and the other
            raise InputError(
                f"`video_offset` is that of the second of two videos, but {len(addresses)} are given. Leave "
                "it out: offsets are then estimated from the motion of the target."
            )
        return Videos(addresses, [0.0, settings.video_offset], settings.every)
    if target is None:
        raise InputError(
            "The offset in time between the videos is estimated from the motion of the target. Name it: "
            "`target='NAME'`; or give the offset: `video_offset=FRAMES`."
        )
    first, *others = (VideoFile(Path(address.place)) for address in addresses)
    offsets = [0.0, *(offset_frames(first, other, target, progress) for other in others)]
    return Videos(addresses, offsets, settings.every)
