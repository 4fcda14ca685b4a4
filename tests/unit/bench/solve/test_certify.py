"""The benchmark of the acceptance test: its cases, and what counts as wrong."""

import pytest

from labcal.bench.solve.budget_rigs import KINDS
from labcal.bench.solve.certify import CertifyCase, certified_case
from labcal.bench.solve.certify_decision import Decided, clear_cases, is_wrong, share_undecided
from labcal.evaluate.acceptance.decision import Outcome, Uncertainty


@pytest.mark.parametrize("kind", list(KINDS))
def test_decisions_of_a_case_are_right(kind: str) -> None:
    found = certified_case(CertifyCase(kind, 3)).decided
    assert found.keys() == {one.value for one in Uncertainty}
    for one in found.values():
        assert not is_wrong(one)
        assert 0.0 < abs(one.off) <= 8.0


def test_what_is_not_true_is_wrong_and_what_is_left_open_is_not() -> None:
    wrong = {(outcome, conforms) for outcome in Outcome for conforms in (True, False)
             if is_wrong(Decided(outcome=outcome.value, conforms=conforms, off=1.0))}  # fmt: skip
    assert wrong == {(Outcome.CONFORMING, False), (Outcome.NOT_CONFORMING, True)}


def test_clear_cases_are_those_far_from_their_limit() -> None:
    near, far = (Decided(outcome=Outcome.UNDECIDED.value, conforms=True, off=off) for off in (1.0, -7.0))
    stated = Decided(outcome=Outcome.CONFORMING.value, conforms=True, off=6.0)
    assert clear_cases([near, far, stated]) == [far, stated]
    assert share_undecided([near, far, stated]) == pytest.approx(2.0 / 3.0)
    assert share_undecided([]) == 0.0
