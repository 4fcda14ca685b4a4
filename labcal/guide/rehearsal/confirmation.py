"""The confirmation of a forecast: errors found in rendered pictures beside those that were foretold."""

from dataclasses import dataclass

import numpy as np
from jaxtyping import Float64

from labcal.arrays import PointCovariances, Vectors3


@dataclass(frozen=True)
class Confirmation:
    """Errors of one rendered rig, found and foretold.

    Attributes
    ----------
    views, points : int
        Views that calibrated, and points of further views that were measured.
    dot_rms_px, dot_expected_px : float
        RMS error of a coordinate of measured dots, and the foretold one of dots of their sizes.
    rms_mm, expected_mm : float
        RMS 3-D error of the points in the frame of the first camera, and the foretold one.
    lowest_mm, highest_mm : float
        Range of the RMS error after a single calibration, in 95 of 100.
    """

    views: int
    points: int
    dot_rms_px: float
    dot_expected_px: float
    rms_mm: float
    expected_mm: float
    lowest_mm: float
    highest_mm: float

    @property
    def holds(self) -> bool:
        """True if the error found is within the range of a single calibration."""
        return self.lowest_mm <= self.rms_mm <= self.highest_mm


def rms_length(error: Vectors3) -> float:
    """Return the root mean square length of errors."""
    return float(np.sqrt((error**2).sum(axis=-1).mean()))


def expected_length(covariance: PointCovariances) -> float:
    """Return the root mean square length that covariances state."""
    return float(np.sqrt(np.trace(covariance, axis1=1, axis2=2).mean()))


def rms_coordinate(error: Float64[np.ndarray, "n 2"]) -> float:
    """Return the root mean square of errors of coordinates."""
    return float(np.sqrt((error**2).mean()))
