"""Figures of one case: what every method made of the same data."""

from pydantic import BaseModel, ConfigDict, NonNegativeInt

from labcal.report.values import Measured as Figure


class RegionFigures(BaseModel):
    """Errors of one method in one region."""

    model_config = ConfigDict(frozen=True, extra="forbid")

    measured: str
    n: NonNegativeInt
    """Points that were measured."""
    predicted: NonNegativeInt
    """Points for which the method gives a place."""
    rmse_mm: Figure
    """Root mean square of the 3-D error of those."""
    oracle_mm: Figure
    """The same of the oracle, at the same points."""
    stated: NonNegativeInt
    """Points of these with a covariance."""
    covered: NonNegativeInt
    """Errors within their 95% ellipsoids."""
    extrapolated: NonNegativeInt
    """Points that are flagged as outside the trained volume."""
    predict_seconds: float = 0.0
    """Duration of the prediction of these points with their covariances."""

    @property
    def over_oracle(self) -> float:
        """RMS error over the oracle's."""
        return self.rmse_mm / self.oracle_mm if self.predicted else float("nan")

    @property
    def coverage95(self) -> float:
        """Share of errors within their 95% ellipsoids; NaN where the method states no covariance."""
        return self.covered / self.stated if self.stated else float("nan")


class MethodFigures(BaseModel):
    """One method on the data of a case."""

    model_config = ConfigDict(frozen=True, extra="forbid")

    method: str
    regions: tuple[RegionFigures, ...] = ()
    misfit: bool | None = None
    """The flag `model-misfit`, from training data alone; None where there was no surrogate."""
    expected_mm: Figure = float("nan")
    """Expected RMS error within the trained volume, from training data alone."""
    reason: str | None = None
    """The reason why there are no figures."""
    fit_seconds: Figure = float("nan")
    """Duration of the fit, without `shared_seconds`."""
    shared_seconds: Figure = float("nan")
    """Duration of the fit of `hybrid`, made once in a case, where the method takes from it; else 0."""


class CaseFigures(BaseModel):
    """All methods on the data of a case."""

    model_config = ConfigDict(frozen=True, extra="forbid")

    trained: int = 0
    """Training points that both cameras see."""
    beyond_pinhole_px: Figure = float("nan")
    pixel_error_px: Figure = float("nan")
    """RMS of each coordinate of detected pixels beside the exact ones; NaN of simulated pixels."""
    methods: tuple[MethodFigures, ...] = ()
    reason: str | None = None
    """The reason why the data could not be drawn."""
