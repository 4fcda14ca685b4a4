"""The target that pictures show which do not show the one that is named."""

from collections.abc import Sequence
from contextlib import suppress

from labcal.correspond.measure import Measurement, measure_picture
from labcal.detect.flags import Refusal
from labcal.errors import InputError
from labcal.targets.catalogue import load_target, target_names

OF_ANOTHER = {
    Refusal.NO_GRID,
    Refusal.NO_RINGS,
    Refusal.AMBIGUOUS_RINGS,
    Refusal.AMBIGUOUS,
    Refusal.SEVERAL_TARGETS,
    Refusal.NO_MARKERS,
    Refusal.OTHER_BOARD,
    Refusal.OTHER_IDS,
    Refusal.NO_CHESSBOARD,
    Refusal.OTHER_CHESSBOARD,
}
"""Refusals that another target explains."""
NOTHING_SEEN = {Refusal.NO_DOTS, Refusal.TOO_FEW_DOTS, Refusal.NO_CODED_DOTS}
"""Refusals of pictures in which no target is in sight, or one of another kind."""
_TRIED = 2
"""Pictures in which other targets are looked for."""


def refused_for(measurements: Sequence[Measurement], reasons: set[Refusal]) -> tuple[Measurement, ...]:
    """Return the measurements of pictures that are refused for one of some reasons."""
    return tuple(one for one in measurements if one.dots is not None and one.dots.refusal in reasons)


def shown_instead(measurements: Sequence[Measurement], named: str) -> str | None:
    """Return the shipped target that pictures show instead of the named one; None where there is none.

    Parameters
    ----------
    measurements : sequence of Measurement
        Of all pictures; the first refused ones are looked at again.
    named : str
        Name of the target that they were said to show.
    """
    refused = refused_for(measurements, OF_ANOTHER) or refused_for(measurements, NOTHING_SEEN)
    if not refused:
        return None
    for name in target_names():
        if name == named:
            continue
        with suppress(InputError):
            target = load_target(name)
            if all(measure_picture(one.source, target).indexed for one in refused[:_TRIED]):
                return name
    return None
