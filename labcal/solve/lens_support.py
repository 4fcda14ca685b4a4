"""Whether views determine a lens's coefficients at all."""

import numpy as np

from labcal.cameras.lens import FISHEYE
from labcal.solve.adjustment.lens_prior import LensPrior
from labcal.solve.adjustment.observations import Observations
from labcal.solve.adjustment.rounds import Adjusted
from labcal.solve.adjustment.state import Lenses

MOST_OPEN = 0.1
"""Standard deviation of a coefficient, over the one that is assumed beforehand, from which on the assumption
decides and not the dots. Where these do, it is a hundredth or less."""
_NAMES = ("k1", "k2", "p1", "p2", "k3", "k4", "k5", "k6", "s1", "s2", "s3", "s4", "tau_x", "tau_y")
_FISHEYE_NAMES = ("k1", "k2", "k3", "k4")


def undetermined(adjusted: Adjusted, observations: Observations) -> tuple[str, ...]:
    """Return the names of the first camera's coefficients that the views leave open.

    Several of them may stand in for each other, as k1 and k4 of the rational model do in a lens that does not
    need both. Their sum is determined then, and so is the picture where dots were. Those are named that the
    prior holds tighter, beyond Brown's five.

    Parameters
    ----------
    adjusted : Adjusted
        With free lenses.
    observations : Observations
        Those that were adjusted.
    """
    camera = adjusted.state.cameras[0]
    own = adjusted.layout.lens[0]
    free = camera.model.coefficients
    if own.stop == own.start or free == 0:
        return ()
    (weight, *_) = LensPrior.of(adjusted.state, observations, Lenses.FREE).weight
    variance = np.diagonal(adjusted.covariance)[own][-free:]
    open_ = ~(weight * variance < MOST_OPEN**2)  # true for NaN
    names = _FISHEYE_NAMES if camera.lens == FISHEYE else _NAMES
    return tuple(name for name, is_open in zip(names, open_, strict=False) if is_open)
