"""A disagreement of cameras on the poses of the target, and its likely causes."""

from dataclasses import dataclass
from enum import StrEnum

from labcal.errors import InputError
from labcal.wording import listed


class CauseName(StrEnum):
    """A possible cause; the names are those of the checks of a shoot."""

    SWAPPED_CAMERAS = "swapped-cameras"
    CAMERA_MOVED = "camera-moved"
    UNSYNCHRONISED = "unsynchronised"
    TURNED_TARGET = "turned-target"
    REFOCUSED = "refocused"
    ROLLING_SHUTTER = "rolling-shutter"
    BENT_BOARD = "bent-board"
    WRONG_PITCH = "wrong-pitch"
    LENS_MISFIT = "lens-misfit"


@dataclass(frozen=True)
class Cause:
    """One possible cause."""

    cause: CauseName
    why: str
    """Reason for the cause and advice, in words."""
    cameras: tuple[str, ...]
    views: tuple[str, ...]
    """Those that show it, in their order; of a moved camera those after the move."""


@dataclass(frozen=True)
class Disagreement:
    """Cameras that do not agree on where the target was."""

    causes: tuple[Cause, ...]
    """The likeliest one first; at least one."""
    times: float
    """Factor by which variances between views exceed the errors, of the worst pair."""

    @property
    def cameras(self) -> tuple[str, ...]:
        """All cameras that a cause names."""
        return tuple(dict.fromkeys(name for cause in self.causes for name in cause.cameras))

    @property
    def views(self) -> tuple[str, ...]:
        """The views that show the likeliest cause."""
        return self.causes[0].views


class ContradictionError(InputError):
    """Cameras contradict each other so much that no rig explains the dots.

    Parameters
    ----------
    disagreement : Disagreement
        What is likely to have happened.
    rms_alone_px : float
        OpenCV's RMS over all cameras, each calibrated alone.
    """

    def __init__(self, disagreement: Disagreement, rms_alone_px: float) -> None:
        super().__init__(
            "The cameras contradict each other, so that no rig explains the dots: "
            f"{disagreement.causes[0].why} Views that show it: {listed(disagreement.views)}."
        )
        self.disagreement = disagreement
        self.rms_alone_px = rms_alone_px

    @property
    def causes(self) -> tuple[Cause, ...]:
        """The likely causes, the likeliest first: each with its name, cameras and views."""
        return self.disagreement.causes

    @property
    def views(self) -> tuple[str, ...]:
        """The views that show the likeliest cause."""
        return self.disagreement.views

    @property
    def times(self) -> float:
        """Variance between views over the variance that errors explain, of the worst pair."""
        return self.disagreement.times

    def __reduce__(self) -> tuple[type["ContradictionError"], tuple[Disagreement, float]]:
        """Let it be pickled, so that a worker process can hand it on."""
        return type(self), (self.disagreement, self.rms_alone_px)
