"""The tested claims of the paper, as ``results.json`` holds them."""

from typing import Annotated

from pydantic import BaseModel, ConfigDict, Field

from labcal.report.values import Measured, Words

_MOST = 100
"""Of comparisons of a claim."""
Probability = Annotated[float, Field(ge=0.0, le=1.0)]
Factor = Annotated[float, Field(ge=1.0, le=1000.0)]
"""Of a statement about a ratio."""


class ComparisonResult(BaseModel):
    """A statement about the ratio of two figures at the same seed, tested."""

    model_config = ConfigDict(frozen=True, extra="forbid")

    where: Words
    of: Words
    """Name of the arm in the plan."""
    over: Words
    """Name of the other arm, or the value in the figure's unit."""
    figure: Words
    statement: Words
    """Of the ratio: at most, more than, or equivalent to 1 within `factor`."""
    factor: Factor
    pairs: int
    """Number of seeds."""
    ratio: Measured
    """Hodges-Lehmann estimate over the pairs."""
    interval: tuple[Measured, Measured]
    """Of `ratio`, 95%; null where there are too few pairs for one."""
    p: Probability
    """Two-sided, exact, before Holm's correction."""
    supported: bool | None
    """Null where the claim is not decided."""


class ClaimResult(BaseModel):
    """A claim of the paper with its verdict."""

    model_config = ConfigDict(frozen=True, extra="forbid")

    claim: Words
    text: Words
    expected: Words
    """Our expectation before the first run."""
    verdict: Words
    where: tuple[Words, ...]
    """Conditions under which it holds; empty unless the verdict is "holds only where"."""
    effect: Measured
    """Ratio of the comparison with the greatest p value, which decides the claim."""
    interval: tuple[Measured, Measured]
    """Of `effect`, 95%."""
    p: Probability
    adjusted_p: Probability
    """After Holm's correction over the claims that were run together."""
    comparisons: Annotated[tuple[ComparisonResult, ...], Field(max_length=_MOST)]
