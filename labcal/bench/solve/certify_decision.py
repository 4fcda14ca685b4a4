"""One decision of the acceptance test about a limit near the true largest error, and what is wrong of it."""

import numpy as np
from pydantic import BaseModel, ConfigDict

from labcal.correspond.named_points import NamedPoints
from labcal.evaluate.acceptance.certified import certified
from labcal.evaluate.acceptance.certify_settings import CertifySettings
from labcal.evaluate.acceptance.decision import Outcome, Uncertainty
from labcal.evaluate.acceptance.length_plan import LengthPlan
from labcal.evaluate.acceptance.measured_lengths import measured_lengths
from labcal.evaluate.acceptance.reference_lengths import ReferenceLengths
from labcal.report.values import Measured

MOST_WRONG = 0.05
_REFERENCE = 0.05
"""Standard uncertainty of calibrated lengths, in units of the largest error."""
_NEAR = 8.0
"""Standard uncertainties within which limits lie on both sides of the true largest error."""
_LEAST_LIMIT = 0.95
"""Of the largest error, by how much a limit lies below it at most."""
_CLEAR = 5.0
"""The same, beyond which a case should be decided: both guard bands and the error in them."""


class Decided(BaseModel):
    """One decision, and the truth."""

    model_config = ConfigDict(frozen=True, extra="forbid")

    outcome: str
    conforms: bool
    """The true largest error is within the limit."""
    off: Measured
    """Limit minus true largest error in standard uncertainties of the test: those of the worst length where
    it does not conform, else those of the most uncertain one."""


def is_wrong(one: Decided) -> bool:
    """Tell whether a decision states what is not true."""
    stated = {Outcome.CONFORMING.value: True, Outcome.NOT_CONFORMING.value: False}
    return one.outcome in stated and stated[one.outcome] is not one.conforms


def clear_cases(decided: list[Decided]) -> list[Decided]:
    """Return the cases whose limit is so far from the true error that they should be decided."""
    return [one for one in decided if abs(one.off) > _CLEAR]


def share_undecided(decided: list[Decided]) -> float:
    """Return the share of cases that are left undecided."""
    return float(np.mean([one.outcome == Outcome.UNDECIDED.value for one in decided])) if decided else 0.0


def decided_near_limit(
    kind: Uncertainty, plan: LengthPlan, points: tuple[NamedPoints, NamedPoints], random: np.random.Generator
) -> Decided:
    """Return one decision: about errors that stay, or about those that were measured.

    Parameters
    ----------
    kind : Uncertainty
    plan : LengthPlan
        Its ends are the true places.
    points : tuple of NamedPoints
        Both ends, all `a` and then all `b`, by the calibrated rig: from exact pixels, and as measured.
    random : Generator
        Of the limit, and of the errors of the calibrated lengths.
    """
    exact, noisy = points
    true, form, n = plan.nominal_mm, plan.lengths(), len(plan.end_a)
    judged = exact if kind is Uncertainty.REPEATED else noisy
    error = np.abs(np.linalg.norm(judged.point[:n] - judged.point[n:], axis=1) - true)
    worst = int(np.argmax(error))
    sigma = _REFERENCE * float(error[worst])
    nominal = true + sigma * random.standard_normal(n)
    reference = ReferenceLengths(
        form.line,
        form.length,
        form.view_a,
        form.point_a,
        form.view_b,
        form.point_b,
        nominal,
        np.full(n, sigma),
    )
    of_test = np.full(n, sigma)
    if kind is Uncertainty.REPEATED:
        of_test = np.hypot(of_test, measured_lengths(noisy, reference).noise_sigma_mm)
    # No limit is below zero: where the errors that stay are small, all limits of interest are beyond them.
    lowest = -_LEAST_LIMIT * float(error[worst] / of_test[worst])
    off = random.uniform(max(-_NEAR, lowest), _NEAR)
    # One length is enough not to conform; to conform, the most uncertain one must, too.
    unit = float(of_test.max() if off > 0.0 else of_test[worst])
    limit = float(error[worst]) + off * unit
    settings = CertifySettings(limit_mm=limit, uncertainty=kind, date="2026-01-01")
    outcome = certified(noisy, reference, settings).outcome
    return Decided(
        outcome=outcome.value,
        conforms=bool(error[worst] <= limit),
        off=(limit - float(error[worst])) / unit,
    )
