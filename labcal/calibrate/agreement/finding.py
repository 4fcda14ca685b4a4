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
    """

    def __init__(self, disagreement: Disagreement) -> None:
        super().__init__(
            "The cameras contradict each other, so that no rig explains the dots: "
            f"{disagreement.causes[0].why} Views that show it: {listed(disagreement.views)}."
        )
        self.disagreement = disagreement

    def __reduce__(self) -> tuple[type["ContradictionError"], tuple[Disagreement]]:
        """Support pickling, so that a worker process can return it."""
        return type(self), (self.disagreement,)
