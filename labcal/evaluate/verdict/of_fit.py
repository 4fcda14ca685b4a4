"""The verdict on fitted methods, by rules."""

from collections.abc import Sequence
from dataclasses import dataclass
from math import isfinite

from labcal.estimators.expected_error import ExpectedError
from labcal.evaluate.verdict.amounts import millimetres, percent
from labcal.evaluate.verdict.finding import Finding, Rules
from labcal.evaluate.verdict.shared_doubts import contradiction
from labcal.evaluate.verdict.verdict import Belief, Verdict
from labcal.wording import counted

FEW_DOTS = 60
"""Fewer training dots fill no volume."""
AT_THE_LIMIT = 1.2
"""Times what pixels leave up to which noise is the limit."""


@dataclass(frozen=True)
class MethodEvidence:
    """One fitted method.

    Attributes
    ----------
    method : str
    n : int
        Training dots.
    training_rmse_mm : float
        On the training dots.
    expected : ExpectedError or None
        Between them.
    """

    method: str
    n: int
    training_rmse_mm: float
    expected: ExpectedError | None

    @property
    def usable(self) -> bool:
        """True if an expected error is stated, and neither it nor the stated covariance is amiss."""
        return self.expected is not None and not self.expected.misfit


@dataclass(frozen=True)
class FitEvidence:
    """Evidence for the rules.

    Attributes
    ----------
    methods : sequence of MethodEvidence
        Those that could be fitted.
    volume : str
        Of the training dots, in words.
    validated : bool
        True if surrogate validation was asked for.
    causes : tuple of str
        Of contradictions between the views of a hand-held target.
    """

    methods: Sequence[MethodEvidence]
    volume: str
    validated: bool
    causes: tuple[str, ...] = ()

    @property
    def best(self) -> MethodEvidence | None:
        """The method to use: the least expected error among those without misfit, else among all."""
        known = [one for one in self.methods if one.expected is not None and isfinite(one.expected.rmse_mm)]
        chosen = [one for one in known if one.usable] or known
        if chosen:
            return min(chosen, key=_expected_rmse)
        return next(iter(self.methods), None)


def fit_verdict(evidence: FitEvidence) -> Verdict:
    """Return which of the fitted methods to use, and what to expect of it."""
    return _RULES.verdict(evidence, _expectation(evidence), _leaves_out(evidence))


def _expected_rmse(one: MethodEvidence) -> float:
    return float("inf") if one.expected is None else one.expected.rmse_mm


def _expectation(evidence: FitEvidence) -> str:
    best = evidence.best
    if best is None:
        return "no points: not one method could be fitted"
    if best.expected is None:
        return (
            f"an unknown error of '{best.method}' between the training dots; on the dots themselves it is "
            f"{millimetres(best.training_rmse_mm)} (RMS)"
        )
    expected = best.expected
    known = expected.total_mm if isfinite(expected.total_mm) else expected.rmse_mm
    return f"a 3-D error of {millimetres(known)} (RMS) of '{best.method}' {evidence.volume}"


def _none_fitted(evidence: FitEvidence) -> Finding | None:
    if evidence.methods:
        return None
    return Finding(
        Belief.NO, "every method was refused", "the training data", "read why each method was refused"
    )


def _contradiction(evidence: FitEvidence) -> Finding | None:
    return contradiction(evidence.causes)


def _not_validated(evidence: FitEvidence) -> Finding | None:
    best = evidence.best
    if best is None or best.expected is not None:
        return None
    if evidence.validated:
        return Finding(
            Belief.PARTLY,
            "the dots, all on one plane perhaps, determine no cameras for surrogate validation",
            "not known",
            "train on two planes or more, or score test views with 'labcal evaluate'",
        )
    return Finding(
        Belief.PARTLY,
        "surrogate validation was left out",
        "not known",
        "fit again with surrogate validation, or score test views with 'labcal evaluate'",
    )


def _misfit(evidence: FitEvidence) -> Finding | None:
    best = evidence.best
    if best is None or best.expected is None or not best.expected.misfit:
        return None
    expected = best.expected
    if expected.too_large:
        return Finding(
            Belief.PARTLY,
            f"its error is {expected.rmse_mm / expected.limit_mm:.1f} times what the noise leaves",
            f"the method '{best.method}', not the noise",
            "fit 'hybrid' too, or give the network more dots",
        )
    return Finding(
        Belief.PARTLY,
        f"its stated 95% ellipsoids hold only {percent(expected.coverage95)}",
        "something that its stated sigma does not hold",
        "take the expected error, not the stated sigma, for the uncertainty of a point",
    )


def _few_dots(evidence: FitEvidence) -> Finding | None:
    best = evidence.best
    if best is None or best.n >= FEW_DOTS:
        return None
    return Finding(
        Belief.PARTLY,
        f"{counted(best.n, 'training dot')} leave much of the volume empty",
        "the number of training dots",
        "train on more views",
    )


def _sound(evidence: FitEvidence) -> Finding:
    best = evidence.best
    expected = None if best is None else best.expected
    if best is None or expected is None:
        raise ValueError("A rule finds what has no expected error.")
    times = expected.rmse_mm / expected.limit_mm if expected.limit_mm > 0.0 else float("nan")
    held = percent(expected.coverage95)
    reason = f"surrogate validation, on cameras like these, finds {held} of the points in its 95% ellipsoids"
    advice = f"reconstruct with '{best.method}', and score views that it has not seen with 'labcal evaluate'"
    if expected.adjustment_mm > expected.rmse_mm:
        limit = (
            "the adjustment of the pictures, which placed the target: it leaves "
            f"{millimetres(expected.adjustment_mm)} (RMS), which points share"
        )
    elif times <= AT_THE_LIMIT:
        limit = f"the noise of the dots, which alone leaves {millimetres(expected.limit_mm)}"
    else:
        limit = f"the method: the error is {times:.1f} times what the noise of the dots leaves"
    return Finding(Belief.YES, reason, limit, advice)


def _leaves_out(evidence: FitEvidence) -> list[str]:
    left = [
        "places outside the trained volume, where every method guesses",
        "what the surrogate's cameras do not show: they follow the training dots, and not what lies between",
        _of_places(evidence),
    ]
    return left if evidence.methods else []


def _of_places(evidence: FitEvidence) -> str:
    """Return what is not known of the errors of the places that were trained."""
    expected = [one.expected for one in evidence.methods if one.expected is not None]
    if any(one.adjustment_mm > 0.0 for one in expected):
        return "what all views of the target have in common: a print that is too large or bent as a whole"
    return "errors of the trained places: of the stage, or of the adjustment that placed the target"


_RULES = Rules[FitEvidence](
    doubts=(_none_fitted, _contradiction, _not_validated, _misfit, _few_dots), sound=_sound
)
