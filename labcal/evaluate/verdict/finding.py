"""Findings: what rules see in a result, in the order of their weight."""

from collections.abc import Callable, Iterable
from dataclasses import dataclass
from typing import Generic, TypeVar

from labcal.evaluate.verdict.verdict import Belief, Verdict

Evidence = TypeVar("Evidence")


@dataclass(frozen=True)
class Finding:
    """A doubt that a rule finds: how far it shakes belief, its reason, the limit then, and what to do."""

    belief: Belief
    reason: str
    limit: str
    advice: str


Rule = Callable[[Evidence], Finding | None]
"""A rule: a finding where it applies, else None."""


@dataclass(frozen=True)
class Rules(Generic[Evidence]):
    """Rules for one kind of result.

    Attributes
    ----------
    doubts : tuple of Rule
        What shakes belief, the heaviest first. The first finding names the limit and the advice.
    sound : callable
        The finding where no rule applies.
    """

    doubts: tuple[Rule[Evidence], ...]
    sound: Callable[[Evidence], Finding]

    def verdict(self, evidence: Evidence, expectation: str, leaves_out: Iterable[str]) -> Verdict:
        """Return the verdict on a result.

        Parameters
        ----------
        evidence : object
            What the rules look at.
        expectation : str
            What to expect, in mm.
        leaves_out : iterable of str
            Errors that this does not hold.
        """
        found = [finding for rule in self.doubts if (finding := rule(evidence)) is not None]
        found = found or [self.sound(evidence)]
        order = list(Belief)
        worst = max((finding.belief for finding in found), key=order.index)
        first = found[0]
        reasons = tuple(finding.reason for finding in found)
        return Verdict(expectation, worst, reasons, first.limit, first.advice, tuple(leaves_out))
