"""A value measured from several points of one rig, with the shares of its uncertainty."""

from collections.abc import Mapping
from dataclasses import dataclass

import numpy as np

from labcal.public_object import PublicObject
from labcal.reconstruct.chosen_points import Shares
from labcal.reconstruct.point_budget import Budget


@dataclass(frozen=True, eq=False, repr=False)
class Measured(PublicObject):
    """A value computed from points, with its standard deviation from their joint covariance.

    Attributes
    ----------
    value : float
    sigma : float
        Standard deviation by all that the budget holds, in the unit of the value.
    noise_sigma, calibration_sigma, stated_sigma : float
        Shares of pixel noise, of the calibration (with the scale, where bars correct it), and of what was
        stated: known coordinates of a frame, lengths of scale bars. Their squares add up. The second one is 0
        where the budget is that of noise alone and there are no bars.
    unit : str
        ``mm`` or ``rad``.
    budget : Budget
        The sources of errors that `sigma` holds.

    Examples
    --------
    >>> import labcal
    >>> from labcal import examples, pipeline
    >>> found = pipeline.reconstruct(examples.rig(), examples.detections(), examples.TARGET)
    >>> round(labcal.distance(found, 0, 1).value, 1)  # neighbours on the board
    20.0
    """

    value: float
    sigma: float
    noise_sigma: float
    calibration_sigma: float
    stated_sigma: float
    unit: str
    budget: Budget

    @classmethod
    def of(cls, value: float, shares: Shares, unit: str) -> "Measured":
        """Return a value with the shares of its variance, which are 1 x 1."""
        parts = [max(0.0, float(one[0, 0])) for one in (shares.noise, shares.calibration, shares.stated)]
        noise, calibration, stated = np.sqrt(parts).tolist()
        return cls(value, float(np.sqrt(sum(parts))), noise, calibration, stated, unit, shares.budget)

    def _summary(self) -> Mapping[str, object]:
        summary: dict[str, object] = {
            "value": f"{self.value:.9g} {self.unit}",
            "sigma": f"{self.sigma:.3g}",
            "noise": f"{self.noise_sigma:.3g}",
            "calibration": f"{self.calibration_sigma:.3g}",
        }
        if self.stated_sigma > 0.0:
            summary["stated"] = f"{self.stated_sigma:.3g}"
        return {**summary, "budget": self.budget.value}
