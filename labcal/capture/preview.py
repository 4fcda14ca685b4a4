"""Pictures between two sets: what the cameras see while nothing is taken."""

from collections.abc import Callable, Collection

from labcal.capture.source import CameraInfo, FrameSet, Source, Waiting


class Previewed:
    """A source that can be looked through before a set is taken.

    A source that has a method `peek` shows what that returns; another live one takes pictures for it, and the
    next set is a new one. A recording shows the set that comes next, which is then taken as it was shown.

    Parameters
    ----------
    source : Source
    """

    def __init__(self, source: Source) -> None:
        self._source, self.live, self.waits = source, source.live, isinstance(source, Waiting)
        self._next: FrameSet | None = None

    def open(self) -> None:
        """Open the source."""
        self._source.open()

    def describe(self) -> tuple[CameraInfo, ...]:
        """Return its cameras."""
        return self._source.describe()

    def peek(self) -> FrameSet | None:
        """Return what the cameras see now; None where there are no more pictures.

        A set without frames says that another program has not delivered the next one yet.

        Raises
        ------
        DeviceError
            A camera was unplugged, or gave no picture in time.
        """
        look: Callable[[], FrameSet | None] | None = getattr(self._source, "peek", None)
        if look is not None:
            return look()
        if self.live:
            return self._source.trigger()
        if self._next is None:
            self._next = self._source.trigger()
        return self._next

    def trigger(self) -> FrameSet | None:
        """Take one set."""
        taken, self._next = self._next, None
        return self._source.trigger() if taken is None else taken

    def follow(self) -> FrameSet | None:
        """Take a set right after the last one."""
        return self._source.follow()

    def skip(self, views: Collection[str]) -> None:
        """Leave out views that a shoot has already."""
        self._source.skip(views)

    def close(self) -> None:
        """Close the source."""
        self._next = None
        self._source.close()
