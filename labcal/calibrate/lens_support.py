"""Test whether views determine the coefficients of a lens."""

import numpy as np

from labcal.calibrate.adjustment.observations import Observations
from labcal.calibrate.adjustment.prior_term import LensPrior
from labcal.calibrate.adjustment.rounds import Adjusted
from labcal.calibrate.adjustment.state import Lenses
from labcal.calibrate.lens_prior import PriorWidth

MOST_OPEN = 0.1
"""Standard deviation of a coefficient, over the one that is assumed beforehand, from which on the assumption
decides and not the dots. Where these do, it is a hundredth or less."""


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
    (weight, *_) = LensPrior.of(adjusted.state, observations, Lenses.FREE, PriorWidth.WIDE).weight
    variance = np.diagonal(adjusted.covariance)[own][-free:]
    open_ = ~(weight * variance < MOST_OPEN**2)  # true for NaN
    return tuple(name for name, is_open in zip(camera.model.names, open_, strict=True) if is_open)
