"""A statement about a ratio, tested on paired logarithms."""

import math
from dataclasses import dataclass
from enum import StrEnum

import numpy as np

from labcal.paper.claims.statistics import Interval, hodges_lehmann, one_sided_p


class Statement(StrEnum):
    """Kinds of statements about a ratio and a factor F."""

    AT_MOST = "at most"
    """It is smaller than F."""
    MORE_THAN = "more than"
    """It is greater than F."""
    EQUIVALENT = "equivalent"
    """It lies between 1/F and F."""

    @property
    def field(self) -> str:
        """Name of the key in the plan."""
        return self.value.replace(" ", "_")


@dataclass(frozen=True)
class Evidence:
    """Evidence for and against a statement.

    Attributes
    ----------
    supported_p, refuted_p : float
        p values of the one-sided tests for the statement and for its opposite.
    log10_ratio : Interval
        Hodges-Lehmann estimate of log10 of the ratio, with its 95% interval.
    n : int
        Number of pairs.
    """

    supported_p: float
    refuted_p: float
    log10_ratio: Interval
    n: int

    @property
    def p(self) -> float:
        """The two-sided p value: twice the smaller one, at most 1."""
        return min(1.0, 2.0 * min(self.supported_p, self.refuted_p))

    @property
    def supported(self) -> bool:
        """True if the evidence is for the statement rather than against it."""
        return self.supported_p < self.refuted_p


def evidence_of(log10_ratios: np.ndarray, statement: Statement, factor: float) -> Evidence:
    """Test a statement on the ratios of n pairs.

    Parameters
    ----------
    log10_ratios : ndarray, shape (n,)
    statement : Statement
    factor : float
        Positive; above 1 for an equivalence.

    Raises
    ------
    InputError
        There are no ratios, or one is not finite.
    """
    bound = math.log10(factor)
    below, above = (one_sided_p(log10_ratios, side, bound) for side in ("less", "greater"))
    match statement:
        case Statement.AT_MOST:
            supported, refuted = below, above
        case Statement.MORE_THAN:
            supported, refuted = above, below
        case Statement.EQUIVALENT:
            within, beyond = (one_sided_p(log10_ratios, side, -bound) for side in ("greater", "less"))
            supported = max(below, within)  # two one-sided tests
            refuted = min(1.0, 2.0 * min(above, beyond))  # beyond either end
    return Evidence(supported, refuted, hodges_lehmann(log10_ratios), len(log10_ratios))
