"""The benchmark of the acceptance test: its cases, and what counts as wrong."""

import pytest

from labcal.bench.solve.budget_rigs import KINDS
from labcal.bench.solve.certify import CertifyCase, Decided, certified_case, is_wrong
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
