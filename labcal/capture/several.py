"""Several sources triggered together, as the cameras of one rig."""

from collections.abc import Callable, Collection, Sequence
from concurrent.futures import ThreadPoolExecutor

from labcal.capture.source import CameraInfo, Frame, FrameSet, Source, Waiting
from labcal.errors import InputError


class SeveralSources:
    """Sources that are triggered at the same moment, each in a thread of its own.

    Parameters
    ----------
    sources : sequence of Source
        Of one camera or more each.
    """

    def __init__(self, sources: Sequence[Source]) -> None:
        self._sources = tuple(sources)
        self._pool: ThreadPoolExecutor | None = None
        self.live = any(source.live for source in self._sources)

    def open(self) -> None:
        """Open all; the first that fails is named by its own error.

        Raises
        ------
        DeviceError
            As of each source.
        InputError
            Two cameras have the same name.
        """
        for source in self._sources:
            source.open()
        names = [camera.name for camera in self.describe()]
        twice = next((name for name in names if names.count(name) > 1), None)
        if twice is not None:
            raise InputError(
                f"Two sources have a camera named '{twice}'. Name them: left=KIND:PLACE right=KIND:PLACE."
            )
        self._pool = ThreadPoolExecutor(len(self._sources), thread_name_prefix="camera")

    def describe(self) -> tuple[CameraInfo, ...]:
        """Return the cameras of all."""
        return tuple(camera for source in self._sources for camera in source.describe())

    def trigger(self) -> FrameSet | None:
        """Trigger all at once and wait for all; None when one has no more.

        Raises
        ------
        DeviceError
            As of the first source that failed.
        """
        return self._together([source.trigger for source in self._sources])

    def follow(self) -> FrameSet | None:
        """Take one more set; None where a source has stills only."""
        return self._together([source.follow for source in self._sources])

    def _together(self, calls: Sequence[Callable[[], FrameSet | None]]) -> FrameSet | None:
        """Call all at once, and put their pictures together; None when one has none."""
        if self._pool is None:
            raise RuntimeError("Call open() before trigger().")
        waiting = [self._pool.submit(call) for call in calls]
        sets = [one.result() for one in waiting]
        taken = [one for one in sets if one is not None]
        if len(taken) < len(sets):
            return None
        return _together(taken)

    def skip(self, views: Collection[str]) -> None:
        """Leave the views out of each source."""
        for source in self._sources:
            source.skip(views)

    def close(self) -> None:
        """Close all, also those that failed."""
        if self._pool is not None:
            self._pool.shutdown()
            self._pool = None
        for source in self._sources:
            source.close()


def _together(taken: Sequence[FrameSet]) -> FrameSet:
    """Return the pictures of several sources as one set."""
    frames: dict[str, Frame] = {name: frame for one in taken for name, frame in one.frames.items()}
    views = {one.view for one in taken}
    poses = [one.T_world_target_nominal for one in taken if one.T_world_target_nominal is not None]
    return FrameSet(
        frames,
        views.pop() if len(views) == 1 else None,
        poses[0] if poses else None,
        taken[0].role,
        tuple(reason for one in taken for reason in one.refusals),
    )


class SeveralWaiting(SeveralSources):
    """Sources that other programs deliver pictures to, and that can be looked at without waiting.

    Parameters
    ----------
    sources : sequence of Source
        Each with a method `peek`.
    """

    waits = True
    """True: pictures come when other programs deliver them."""

    def peek(self) -> FrameSet:
        """Return the set that comes next; without frames, but with reasons, until all sources have one."""
        sets = [one.peek() for one in self._sources if isinstance(one, Waiting)]
        reasons = tuple(reason for one in sets for reason in one.refusals)
        if not all(one.frames for one in sets):
            return FrameSet({}, refusals=reasons)
        return _together(sets)
