"""A verdict: the outcome of a piece of work in one sentence."""

from dataclasses import dataclass
from enum import StrEnum


class Belief(StrEnum):
    """Trust in the expected error."""

    YES = "yes"
    PARTLY = "with reservations"
    NO = "no"


_CLAUSES = {
    Belief.YES: "believe it",
    Belief.PARTLY: "believe it with reservations",
    Belief.NO: "do not believe it",
}


@dataclass(frozen=True)
class Verdict:
    """A verdict by the rules of this package.

    Attributes
    ----------
    expectation : str
        What to expect, in mm, and where: "errors of about 0.08 mm (1 sigma, in 3-D) at 640 mm".
    belief : Belief
    reasons : tuple of str
        Why it is not to be believed, or not wholly, or what speaks for it; the strongest first.
    limit : str
        What limits the accuracy: a noun phrase.
    advice : str
        What to do next: an imperative.
    leaves_out : tuple of str
        Errors that the expectation does not hold.
    """

    expectation: str
    belief: Belief
    reasons: tuple[str, ...]
    limit: str
    advice: str
    leaves_out: tuple[str, ...]

    @property
    def sentence(self) -> str:
        """All of it in one sentence; arguments of the library stand between backticks."""
        because = f" ({self.reasons[0]})" if self.reasons else ""
        belief = f"{_CLAUSES[self.belief]}{because}"
        return f"Expect {self.expectation}; {belief}; the limit is {self.limit}; next, {self.advice}."
