"""The tests of the claims from the figures of all runs."""

import math
from collections.abc import Mapping, Sequence

import numpy as np

from labcal.paper.claims.arm_run import ArmFigures, ArmRun
from labcal.paper.claims.pictured import Pictured
from labcal.paper.claims.plan import Arm, Claim, Comparison
from labcal.paper.claims.statement import Evidence, evidence_of
from labcal.paper.claims.verdict import LEVEL, Decision, Verdict, decisions
from labcal.report.claims import ClaimResult, ComparisonResult

LEAST_FIGURE = 1e-9
"""Errors below count as this, mm: they are rounding errors of exact solutions."""


def claim_runs(claims: Mapping[str, Claim], pictured: Pictured, most_seeds: int | None) -> list[ArmRun]:
    """Return every run that claims need, once.

    Parameters
    ----------
    claims : mapping of str to Claim
    pictured : mapping
        Data from pictures; see :func:`labcal.paper.claims.pictured.pictured_data`.
    most_seeds : int, optional
        Fewer pairs than the plan asks for.
    """
    runs: dict[str, ArmRun] = {}
    for name, claim in claims.items():
        for comparison in claim.comparisons:
            for arm in claim.compared_arms(comparison):
                for seed in range(claim.pairs(comparison, most_seeds)):
                    definition = claim.arms[arm]
                    run = ArmRun(name, arm, definition, seed, pictured.get((definition.data, seed)))
                    runs.setdefault(run.key, run)
    return list(runs.values())


def claim_results(
    claims: Mapping[str, Claim], figures: Mapping[str, ArmFigures], most_seeds: int | None
) -> tuple[ClaimResult, ...]:
    """Return the claims with their verdicts; Holm's correction goes over those that are given.

    Parameters
    ----------
    claims : mapping of str to Claim
    figures : mapping of str to ArmFigures
        By the key of the run.
    most_seeds : int, optional
        Fewer pairs than the plan asks for.
    """
    evidence = {
        name: [_evidence(name, claim, one, figures, most_seeds) for one in claim.comparisons]
        for name, claim in claims.items()
    }
    decided = decisions(evidence)
    return tuple(_result(name, claims[name], evidence[name], decided[name]) for name in claims)


def _evidence(
    name: str,
    claim: Claim,
    comparison: Comparison,
    figures: Mapping[str, ArmFigures],
    most_seeds: int | None,
) -> Evidence:
    seeds = range(claim.pairs(comparison, most_seeds))

    def of_arm(arm: str, definition: Arm) -> np.ndarray:
        runs = [figures[ArmRun(name, arm, definition, seed).key] for seed in seeds]
        return np.log10([max(getattr(one, comparison.figure), LEAST_FIGURE) for one in runs])

    of, over = (comparison.of, comparison.over)
    reference = of_arm(over, claim.arms[over]) if isinstance(over, str) else math.log10(over)
    return evidence_of(of_arm(of, claim.arms[of]) - reference, comparison.statement, comparison.factor)


def _result(name: str, claim: Claim, evidence: Sequence[Evidence], decision: Decision) -> ClaimResult:
    """Return the document of a claim; its effect is that of the comparison with the greatest p value."""
    compared = tuple(
        _comparison(one, found, decided=decision.adjusted_p <= LEVEL)
        for one, found in zip(claim.comparisons, evidence, strict=True)
    )
    weakest = compared[max(range(len(evidence)), key=lambda i: evidence[i].p)]
    holds_where = tuple(one.where for one in compared if one.supported)
    return ClaimResult(
        claim=name,
        text=claim.claim,
        expected=claim.expected,
        verdict=decision.verdict,
        where=holds_where if decision.verdict is Verdict.PARTLY else (),
        effect=weakest.ratio,
        interval=weakest.interval,
        p=decision.p,
        adjusted_p=decision.adjusted_p,
        comparisons=compared,
    )


def _comparison(comparison: Comparison, found: Evidence, *, decided: bool) -> ComparisonResult:
    interval = found.log10_ratio
    return ComparisonResult(
        where=comparison.where,
        of=comparison.of,
        over=str(comparison.over),
        figure=comparison.figure,
        statement=comparison.statement,
        factor=comparison.factor,
        pairs=found.n,
        ratio=10.0**interval.estimate,
        interval=(_power(interval.low), _power(interval.high)),
        p=found.p,
        supported=found.supported if decided else None,
    )


def _power(exponent: float) -> float:
    """Return 10 to a power; NaN for an end that the interval does not have."""
    return float(10.0**exponent) if math.isfinite(exponent) else float("nan")
