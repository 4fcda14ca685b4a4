"""Mistakes of the rendered laboratory as they act on exact pixels, made by the laboratory's own code."""

from functools import partial

from labcal.bench.faults.planned_planes import PlannedPlanes
from labcal.bench.faults.wrong_boards import ExactPixels, other_pitch
from labcal.errors import InputError
from labcal.scene.mistakes import PITCH_FACTOR, Mistake, Shooting, make_mistake

ON_PICTURES_ONLY = frozenset({Mistake.OUT_OF_FOCUS})
"""Mistakes that leave the exact pixels of a dot as they are."""
WITHOUT_SIZE = frozenset({Mistake.BOARD_TURNED})


def mistaken(mistake: Mistake, planes: PlannedPlanes, size: float) -> ExactPixels:
    """Return the exact pixels of a shooting with a mistake.

    Parameters
    ----------
    mistake : Mistake
    planes : PlannedPlanes
        All views are trained on, and a stage reports their places.
    size : float
        A multiple of the mistake's usual size, as the key ``mistake_size`` of a scene.

    Raises
    ------
    InputError
        The mistake acts on pictures only, or has no such size.
    """
    if mistake in ON_PICTURES_ONLY:
        raise InputError(
            f"'{mistake}' acts on pictures only: simulated points do not show it. It is measured with "
            "pictures, by `rendered=True`."
        )
    if mistake is Mistake.WRONG_PITCH:
        return other_pitch(planes, size * (PITCH_FACTOR - 1.0))
    views = frozenset(take.view for take in planes.takes)
    made = make_mistake(
        mistake, Shooting(planes.takes, on_stage=True, training=views, seed=planes.seed, size=size)
    )
    return planes.images(planes.dots, made.takes)


MISTAKES = {mistake: partial(mistaken, mistake) for mistake in Mistake}
