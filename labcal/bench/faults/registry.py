"""The faults by name; a new one is a line here, and a mistake of the laboratory comes by itself."""

import re
from collections.abc import Callable
from dataclasses import dataclass

from labcal.arguments import one_named
from labcal.bench.faults import wrong_boards
from labcal.bench.faults.laboratory_mistakes import MISTAKES, ON_PICTURES_ONLY, WITHOUT_SIZE
from labcal.bench.faults.planned_planes import PlannedPlanes
from labcal.bench.faults.wrong_boards import ExactPixels
from labcal.errors import InputError
from labcal.scene.mistakes import Mistake
from labcal.scene.model import MOST_MISTAKE


@dataclass(frozen=True)
class FaultKind:
    """One kind of fault.

    Attributes
    ----------
    name : str
    size : str
        The meaning of the size, for people.
    usual : float
        The size where none is named.
    step : float
        The part of a size that sensitivities are given for.
    per : str
        The step, for people.
    most : float
        Greatest size.
    images : callable
        From the plan and the size to the exact pixels of the training points.
    on_pictures_only : bool
        It leaves exact pixels as they are.
    has_size : bool
    """

    name: str
    size: str
    usual: float
    step: float
    per: str
    most: float
    images: Callable[[PlannedPlanes, float], ExactPixels]
    on_pictures_only: bool = False
    has_size: bool = True


def _mistake(mistake: Mistake) -> FaultKind:
    return FaultKind(
        name=str(mistake),
        size="multiple of the usual size",
        usual=1.0,
        step=1.0,
        per="the usual size",
        most=1.0 if mistake in {Mistake.SWAPPED_CAMERAS, *WITHOUT_SIZE} else MOST_MISTAKE,
        images=MISTAKES[mistake],
        on_pictures_only=mistake in ON_PICTURES_ONLY,
        has_size=mistake not in WITHOUT_SIZE,
    )


_KINDS = (
    FaultKind(
        "pitch", "excess of all distances on the board, as a share", 0.001, 0.001, "0.1% of pitch", 0.5,
        wrong_boards.other_pitch,
    ),
    FaultKind("bend", "sag, mm", 1.0, 1.0, "1 mm of sag", 500.0, wrong_boards.bent),
    FaultKind(
        "misprint", "standard deviation of each dot along x and y, mm", 0.1, 0.1, "0.1 mm of misprint", 100.0,
        wrong_boards.misprinted,
    ),
    FaultKind(
        "stage", "standard deviation of each view along x, y and z, mm", 0.1, 0.1, "0.1 mm of reading", 100.0,
        wrong_boards.misread,
    ),
    *map(_mistake, Mistake),
)  # fmt: skip
FAULT_KINDS = {kind.name: kind for kind in _KINDS}


@dataclass(frozen=True)
class Fault:
    """A kind of fault with its size."""

    kind: FaultKind
    size: float

    @property
    def name(self) -> str:
        """The name with the size, as in ``pitch-0.001``."""
        return f"{self.kind.name}-{self.size:g}" if self.kind.has_size else self.kind.name


def fault_named(text: str) -> Fault:
    """Return a fault by its name: that of the kind, a hyphen and the size, which may be left out.

    Raises
    ------
    UnknownNameError
        There is no such kind; the nearest one is offered.
    InputError
        The size is no number, or is not allowed.

    Examples
    --------
    >>> from labcal.bench.faults.registry import fault_named
    >>> fault_named("bend-2.50").name, fault_named("camera-knocked").name
    ('bend-2.5', 'camera-knocked-1')
    """
    name, number = text, ""
    if text not in FAULT_KINDS and (parts := re.fullmatch(r"(.*?)-([-+.\d].*)", text)):
        name, number = parts[1], parts[2]
    kind = one_named(FAULT_KINDS, "fault", name)
    return Fault(kind, _size(kind, number))


def _size(kind: FaultKind, number: str) -> float:
    """Return the size that a text tells."""
    if not number:
        return kind.usual
    if not kind.has_size:
        raise InputError(f"The fault '{kind.name}' has no size, but '{number}' is given: leave it out.")
    try:
        size = float(number)
    except ValueError:
        size = float("nan")
    if not 0.0 < size <= kind.most:
        raise InputError(
            f"The size of the fault '{kind.name}' ({kind.size}) is '{number}', but should be a number above "
            f"0 and at most {kind.most:g}, as in {kind.name}-{kind.usual:g}."
        )
    return size
