"""Causes that might explain rows 17 to 23, as ``results.json`` holds them."""

from typing import Annotated

from pydantic import BaseModel, ConfigDict, Field

from labcal.bounds import Amount, Finite
from labcal.report.values import Measured, Words

_Count = Annotated[int, Field(ge=0, le=10**9)]
_MOST = 300
"""Of rows, causes and divisors."""


class ExplainedRow(BaseModel):
    """The size of a cause at which a row comes out as printed, under one reading of the printed figure."""

    model_config = ConfigDict(frozen=True, extra="forbid")

    exp: Words
    method: Words
    figure: Words
    """The reading: mean signed error, or RMS error of a coordinate."""
    paper_m: Finite
    size: Measured
    """Median of the seeds; null where less than half of them have one."""
    size_range: tuple[Measured, Measured]
    """Least and greatest of the seeds; null at an end where there is none."""
    solved: _Count
    """Seeds for which a size gives the figure."""
    seeds: _Count
    greatest_m: Measured
    """Greatest error that was met, the median of the seeds."""
    likely: bool
    """True if the size is one that an experimenter may well have."""
    also_gives: tuple[Words, ...]
    """Rows whose own range of sizes holds this size: the same mistake gives them, too."""


class CauseResult(BaseModel):
    """A cause with the sizes that it would need."""

    model_config = ConfigDict(frozen=True, extra="forbid")

    cause: Words
    words: Words
    unit: Words
    likely: tuple[Amount, Amount]
    greatest: Amount
    """Greatest size that was tried."""
    rows: Annotated[tuple[ExplainedRow, ...], Field(max_length=_MOST)]


class QuotientRow(BaseModel):
    """The length by which our error must be divided to give the number that the paper prints."""

    model_config = ConfigDict(frozen=True, extra="forbid")

    exp: Words
    figure: Words
    printed: Finite
    ours_mm: Measured
    """Magnitude; the median of seeds (and of methods of least squares)."""
    quotient_mm: Measured
    quotient_range_mm: tuple[Measured, Measured]
    """Of seeds and methods."""


class DivisorResult(BaseModel):
    """A unit or a length of the experiment, and the rows that a division by it gives."""

    model_config = ConfigDict(frozen=True, extra="forbid")

    divisor: Words
    least_mm: Amount
    greatest_mm: Amount
    """It may differ from scene to scene."""
    mean_signed_rows: tuple[Words, ...]
    """Rows it gives if the figure is a mean signed error."""
    coordinate_rows: tuple[Words, ...]
    """Rows it gives if the figure is the RMS error of a coordinate."""


class Explanations(BaseModel):
    """All causes and divisors."""

    model_config = ConfigDict(frozen=True, extra="forbid")

    causes: Annotated[tuple[CauseResult, ...], Field(max_length=_MOST)]
    quotients: Annotated[tuple[QuotientRow, ...], Field(max_length=_MOST)]
    divisors: Annotated[tuple[DivisorResult, ...], Field(max_length=_MOST)]
