"""Residuals of every dot that entered a calibration, in the rig."""

from dataclasses import dataclass

import numpy as np
from jaxtyping import Bool, Float64, Int64

from labcal.arrays import Pixels
from labcal.calibrate.adjustment.observations import Observations
from labcal.calibrate.adjustment.rounds import Adjusted


@dataclass(frozen=True)
class RigResiduals:
    """Residuals of n dots, by the numbers of their cameras and views in the rig."""

    camera: Int64[np.ndarray, " n"]
    view: Int64[np.ndarray, " n"]
    q: Pixels
    """(n, 2), measured centres of dots, px."""
    residual: Float64[np.ndarray, "n 2"]
    """Predicted minus measured, px."""
    outlier: Bool[np.ndarray, " n"]
    """Mask of outliers, which did not enter the adjustment."""

    @classmethod
    def of(cls, adjusted: Adjusted, observations: Observations) -> "RigResiduals":
        """Return those of the adjustment of a rig."""
        return cls(
            observations.camera, observations.view, observations.q, adjusted.residual, adjusted.outlier
        )

    def rms_px(self, cameras: int, views: int) -> Float64[np.ndarray, "cameras views"]:
        """Return the RMS 2-D distance of each picture without outliers, px; NaN where it has no dot."""
        picture = (self.camera * views + self.view)[~self.outlier]
        square = (self.residual[~self.outlier] ** 2).sum(axis=1)
        dots = np.bincount(picture, minlength=cameras * views)
        total = np.bincount(picture, weights=square, minlength=cameras * views)
        mean = np.divide(total, dots, out=np.full(len(dots), np.nan), where=dots > 0)
        return np.asarray(np.sqrt(mean).reshape(cameras, views))
