"""The joint covariance of a calibration, recorded with its rig."""

import numpy as np

from labcal.bounds import MOST_PARAMETER_VARIANCE
from labcal.calibrate.adjustment.rounds import Adjusted
from labcal.calibrate.budget.error_sources import ErrorSources
from labcal.cameras.rig import Rig
from labcal.cameras.rig_covariance import RigCovariance


def with_covariance(rig: Rig, adjusted: Adjusted, sources: ErrorSources) -> Rig:
    """Return the rig of an adjustment with its joint covariance, where lenses were estimated.

    Of lenses that were kept from another rig the errors are not known here: then none is stated. What the
    views leave open has some very large variance; it moves no point where dots were. Beyond the bounds of
    sense none is stated, either.
    """
    if sources.print_share is None:
        return rig
    free = adjusted.layout.pose[-1].stop
    covariance = sources.with_omitted(adjusted.spread[:free, :free])
    if not (np.isfinite(covariance).all() and np.diagonal(covariance).max() <= MOST_PARAMETER_VARIANCE):
        return rig
    record = RigCovariance.of(rig.cameras, covariance).model_copy(
        update={
            "noise_factor": sources.noise_factor,
            "view_factor": sources.views.factor,
            "print_sigma_mm": sources.print_sigma_mm,
        }
    )
    return rig.model_copy(update={"covariance": record})
