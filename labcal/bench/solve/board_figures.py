"""Figures of one drawn set of a board in the hand."""

from pydantic import BaseModel, ConfigDict

from labcal.report.values import Measured


class BoardFigures(BaseModel):
    """Figures of one set.

    Attributes
    ----------
    pictures, indexed : int
    wrong : int
        Measured places that are not where the place of their id is.
    places : int
        Measured ones.
    error_px, stated_px : float
        RMS 2-D error of the places, and what is stated of them.
    normalised : float
        Squared errors of places in units of their covariance, a coordinate.
    residual : float
        RMS residual of the calibration over what the covariances of the places leave to expect.
    parameters : int
        Of both cameras.
    mean_square : float
        Their squared errors in units of their covariance (squared Mahalanobis distance), a parameter.
    worst : float
        Largest error of a single parameter in units of its standard deviation.
    coverage : float
        Share of points of views that were held out within their 95% ellipsoids.
    error_mm, stated_mm : float
        RMS 3-D error of these points, and what is stated.
    warned : bool
        `calibrate` warns that views disagree, or that the lens lacks coefficients.
    """

    model_config = ConfigDict(frozen=True, extra="forbid")

    pictures: int
    indexed: int
    wrong: int
    places: int
    error_px: Measured
    stated_px: Measured
    normalised: Measured
    residual: Measured
    parameters: int
    mean_square: Measured
    worst: Measured
    coverage: Measured
    error_mm: Measured
    stated_mm: Measured
    warned: bool
