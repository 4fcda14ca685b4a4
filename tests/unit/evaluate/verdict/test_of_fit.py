"""The verdict on fitted methods, rule by rule."""

from dataclasses import replace

import pytest

from labcal.estimators.expected_error import ExpectedError
from labcal.evaluate.verdict.of_fit import FitEvidence, MethodEvidence, fit_verdict
from labcal.evaluate.verdict.verdict import Belief

HYBRID = MethodEvidence("hybrid", 520, 0.3, ExpectedError(0.42, 0.41, 0.95))
NETWORK = MethodEvidence("mlp", 520, 0.02, ExpectedError(4.6, 0.41, 0.4))
GOOD = FitEvidence([NETWORK, HYBRID], "within the trained volume", validated=True)


def test_the_method_that_errs_least_between_the_dots_is_named_not_the_one_that_fits_them_best() -> None:
    verdict = fit_verdict(GOOD)
    assert verdict.belief is Belief.YES
    assert "0.42 mm (RMS) of 'hybrid'" in verdict.expectation
    assert "noise of the dots" in verdict.limit


def test_errors_of_the_adjustment_that_placed_the_target_count() -> None:
    held = replace(HYBRID, expected=ExpectedError(0.42, 0.41, 0.95, adjustment_mm=1.2))
    verdict = fit_verdict(replace(GOOD, methods=[held]))
    assert "1.3 mm (RMS) of 'hybrid'" in verdict.expectation  # the root of the sum of both squares
    assert "1.2 mm (RMS), which points share" in verdict.limit
    assert not any("the adjustment that placed" in left for left in verdict.leaves_out)
    unknown = replace(HYBRID, expected=ExpectedError(0.42, 0.41, 0.95, adjustment_mm=float("nan")))
    verdict = fit_verdict(replace(GOOD, methods=[unknown]))
    assert "0.42 mm (RMS)" in verdict.expectation
    assert any("the adjustment that placed" in left for left in verdict.leaves_out)


def test_a_method_without_misfit_goes_before_one_that_errs_less() -> None:
    liar = MethodEvidence("liar", 520, 0.3, ExpectedError(0.40, 0.41, 0.5))
    assert "'hybrid'" in fit_verdict(replace(GOOD, methods=[liar, HYBRID])).expectation


@pytest.mark.parametrize(
    ("evidence", "belief", "said"),
    [
        (replace(GOOD, methods=[]), Belief.NO, "refused"),
        (replace(GOOD, causes=("swapped-cameras",)), Belief.NO, "swapped-cameras"),
        (replace(GOOD, methods=[replace(HYBRID, expected=None)]), Belief.PARTLY, "one plane"),
        (
            replace(GOOD, methods=[replace(HYBRID, expected=None)], validated=False),
            Belief.PARTLY,
            "was left out",
        ),
        (replace(GOOD, methods=[NETWORK]), Belief.PARTLY, "11.2 times"),
        (
            replace(GOOD, methods=[replace(HYBRID, expected=ExpectedError(0.42, 0.41, 0.5))]),
            Belief.PARTLY,
            "hold only 50%",
        ),
        (replace(GOOD, methods=[replace(HYBRID, n=20)]), Belief.PARTLY, "20 training dots"),
    ],
)
def test_each_doubt_is_said(evidence: FitEvidence, belief: Belief, said: str) -> None:
    verdict = fit_verdict(evidence)
    assert verdict.belief is belief
    assert said in verdict.reasons[0]
