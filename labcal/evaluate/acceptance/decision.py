"""Decision on the conformity of lengths with a limit of error, with the uncertainty of the test."""

from dataclasses import dataclass
from enum import StrEnum

import numpy as np
from jaxtyping import Float64
from scipy.special import ndtri


class Rule(StrEnum):
    """A decision rule."""

    GUARDED = "iso-14253-1"
    """Conformity, and non-conformity, is stated where it is proven: an error counts as within its limit, or
    beyond, if it is so by a guard band that follows from the uncertainty of the test (ISO 14253-1)."""
    SIMPLE = "simple"
    """Errors are compared with their limit as they are (simple acceptance); a case at the limit is decided
    wrongly as often as not."""


class Uncertainty(StrEnum):
    """The uncertainty of the test."""

    REFERENCE = "reference"
    """The calibrated lengths alone: noise of the pixels is the instrument's own, and counts as its error."""
    REPEATED = "noise-and-reference"
    """Noise of the pixels, too: the limit is for errors that stay when the test is repeated."""


class Outcome(StrEnum):
    """The outcome of one length, or of the whole test."""

    CONFORMING = "conforming"
    NOT_CONFORMING = "not-conforming"
    UNDECIDED = "undecided"
    """Within the guard band."""
    INCOMPLETE = "incomplete"
    """Too few lengths were measured, none of which is beyond its limit."""
    NO_LIMIT = "no-limit"
    """No limit was stated."""


@dataclass(frozen=True)
class Decision:
    """The outcome of each length.

    Attributes
    ----------
    guard_within, guard_beyond : float64 array, (n,)
        Distance from the limit, mm, within and beyond which an outcome is proven.
    outcome : ndarray of str, (n,)
        Of :class:`Outcome`.
    """

    guard_within: Float64[np.ndarray, " n"]
    guard_beyond: Float64[np.ndarray, " n"]
    outcome: np.ndarray

    @property
    def whole(self) -> Outcome:
        """The outcome of all lengths together: one beyond its limit is enough, all must be within theirs."""
        for outcome in (Outcome.NOT_CONFORMING, Outcome.UNDECIDED):
            if (self.outcome == outcome.value).any():
                return outcome
        return Outcome.CONFORMING


def decided(
    error_mm: Float64[np.ndarray, " n"],
    limit_mm: Float64[np.ndarray, " n"],
    sigma_mm: Float64[np.ndarray, " n"],
    rule: Rule,
    confidence: float,
) -> Decision:
    """Return the outcome of length errors against their limits.

    Parameters
    ----------
    error_mm : ndarray, shape (n,)
        Measured minus calibrated length.
    limit_mm : ndarray, shape (n,)
        Largest permissible absolute error of each.
    sigma_mm : ndarray, shape (n,)
        Standard uncertainty of each error.
    rule : Rule
    confidence : float
        Probability with which a stated conformity, or non-conformity, is true at least.

    Notes
    -----
    The test conforms if all lengths do, so that the guard band of a single length is enough there: the worst
    length alone decides. It does not conform if any length does not; one of n lengths is beyond its guard
    band by chance n times as easily, so that the chance is divided by n there (Bonferroni).
    """
    chance = 1.0 - confidence
    within, beyond = (
        float(-ndtri(part)) if rule is Rule.GUARDED else 0.0
        for part in (chance, chance / max(len(error_mm), 1))
    )
    guard_within, guard_beyond = within * sigma_mm, beyond * sigma_mm
    size = np.abs(error_mm)
    outcome = np.where(
        size <= limit_mm - guard_within,
        Outcome.CONFORMING.value,
        np.where(size > limit_mm + guard_beyond, Outcome.NOT_CONFORMING.value, Outcome.UNDECIDED.value),
    )
    return Decision(guard_within, guard_beyond, outcome)
