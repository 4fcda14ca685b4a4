"""The state of the live page, apart from the pictures."""

from dataclasses import dataclass
from enum import StrEnum

from labcal.arrays import Pixels


class Phase(StrEnum):
    """The work that goes on at the bench."""

    START = "start"
    """The cameras are being opened."""
    AIM = "aim"
    """A person holds the target; nothing is taken until the page asks for it."""
    TAKE = "take"
    """A view is being taken and judged."""
    CALIBRATE = "calibrate"
    """The rig is being calibrated."""
    DONE = "done"
    """The rig is calibrated, and its page is there."""
    FAILED = "failed"
    """The capture ended with an error."""


@dataclass(frozen=True)
class CameraShown:
    """Drawings over the picture of one camera."""

    name: str
    size: tuple[int, int]
    """Width and height of its pictures, px, in which all places below are given."""
    dots: tuple[tuple[float, float], ...] = ()
    """Dots that were found in the last picture that was looked at."""
    found: bool | None = None
    """True if the target was found and its dots named; None before the first look."""
    outline: tuple[tuple[float, float], ...] = ()
    """Outline of the target at the pose that is asked for."""
    coverage: tuple[tuple[int, ...], ...] = ()
    """Views that have dots in each cell of a coarse grid over the picture, row by row."""


@dataclass(frozen=True)
class ViewShown:
    """A view that is in the shoot."""

    name: str
    remarks: tuple[str, ...] = ()
    """Faults of it, in plain words."""


@dataclass(frozen=True)
class Outcome:
    """A calibrated rig, for the page."""

    sentence: str
    """Its quality, in words."""
    figures: tuple[tuple[str, str], ...]
    """Names and values to be read at once."""
    warnings: tuple[str, ...]
    files: tuple[tuple[str, str], ...]
    """Contents and place of each file."""
    next_step: str
    """The command that goes on from here."""


@dataclass(frozen=True)
class Shown:
    """One state of the live page."""

    phase: Phase = Phase.START
    request: str = "Opening the cameras …"
    """Request to the person, one sentence."""
    hint: str = ""
    """A word of help beside it."""
    cameras: tuple[CameraShown, ...] = ()
    views: int = 0
    """Views in the shoot."""
    taken: tuple[ViewShown, ...] = ()
    """The views, in the order in which they were taken."""
    guided: bool = False
    """True if a pose is asked for before each view."""
    wanted_views: int | None = None
    """Views after which the capture ends; None if a person ends it."""
    least_views: int = 3
    """Views without which nothing can be calibrated."""
    auto: bool = False
    """True if views are taken by themselves."""
    still: bool = False
    """True if the target is found in all pictures and does not move."""
    reached_mm: float | None = None
    """Expected 3-D error over the volume now, RMS, with the share of the calibration."""
    wanted_mm: float | None = None
    faults: tuple[str, ...] = ()
    """Of the last view, in plain words; a refused one begins with why it was refused."""
    findings: tuple[str, ...] = ()
    """Findings of the diagnosis of the shoot, the most harmful first."""
    lacks: tuple[str, ...] = ()
    """Parts of a picture, tilts and distances that the views lack so far."""
    enough: bool = False
    """True if the wanted error is reached, or the recording has no more."""
    ended: bool = False
    """True if the source has no more pictures."""
    work: tuple[str, int, int] | None = None
    """Long work: its name, steps done, steps in all (0 if unknown)."""
    outcome: Outcome | None = None
    error: str = ""
    """The failure of the last piece of work."""
    notice: str = ""
    """Something to know that is no failure, such as a wait that has become long."""


def places_shown(points: Pixels | None) -> tuple[tuple[float, float], ...]:
    """Return points for the page, px, rounded to what can be seen; none of None."""
    if points is None:
        return ()
    return tuple((round(float(x), 1), round(float(y), 1)) for x, y in points)
