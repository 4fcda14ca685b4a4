"""The verdict on a claim from its comparisons, with Holm's correction over all claims."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from enum import StrEnum

from labcal.paper.claims.statement import Evidence
from labcal.paper.claims.statistics import CONFIDENCE, holm

LEVEL = 1.0 - CONFIDENCE


class Verdict(StrEnum):
    """Verdicts on a claim."""

    HOLDS = "holds"
    FAILS = "does not hold"
    PARTLY = "holds only where"
    UNDECIDED = "undecided"


@dataclass(frozen=True)
class Decision:
    """A verdict with its p value.

    Attributes
    ----------
    p : float
        The greatest of the claim's comparisons: a claim is decided only if each of them is.
    adjusted_p : float
        After Holm's correction over all claims.
    """

    verdict: Verdict
    p: float
    adjusted_p: float


def decisions(claims: Mapping[str, Sequence[Evidence]]) -> dict[str, Decision]:
    """Return the verdict on every claim.

    The probability that any verdict but "undecided" rests on a comparison that is decided wrongly is at most
    5% over all claims.

    Parameters
    ----------
    claims : mapping of str to sequence of Evidence
        The tested comparisons of every claim.
    """
    p = {name: max(one.p for one in tested) for name, tested in claims.items()}
    adjusted = dict(zip(p, holm(list(p.values())), strict=True))
    return {
        name: Decision(_verdict(tested, adjusted[name]), p[name], adjusted[name])
        for name, tested in claims.items()
    }


def _verdict(tested: Sequence[Evidence], adjusted_p: float) -> Verdict:
    if adjusted_p > LEVEL:
        return Verdict.UNDECIDED
    supported = [one.supported for one in tested]
    if all(supported):
        return Verdict.HOLDS
    return Verdict.PARTLY if any(supported) else Verdict.FAILS
