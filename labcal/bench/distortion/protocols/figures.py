"""Figures of one case of a protocol: what every method made of the same data."""

from pydantic import BaseModel, ConfigDict

from labcal.report.values import Measured as Figure

ORACLE = "exact cameras"
"""In the place of a method: triangulation of the same pixels with the true cameras."""


class ProtocolMethodFigures(BaseModel):
    """One method by a protocol."""

    model_config = ConfigDict(frozen=True, extra="forbid")

    method: str
    values: tuple[Figure, ...] = ()
    """In the order of the protocol's quantities."""
    coverage95: Figure = float("nan")
    """Share of errors within the stated 95% ellipsoids; NaN where the method states no covariance."""
    misfit: bool | None = None
    """The flag `model-misfit`, from training data alone; None where `hybrid`, its judge, is not measured."""
    reason: str | None = None
    """The reason why there are no figures."""


class ProtocolCaseFigures(BaseModel):
    """All methods on the data of a protocol, the oracle first."""

    model_config = ConfigDict(frozen=True, extra="forbid")

    methods: tuple[ProtocolMethodFigures, ...]
