"""The plan of the claims."""

import pytest

from labcal.errors import InputError
from labcal.paper.claims.plan import Arm, ArmData, Claim, Comparison, Plan, claims_plan
from labcal.paper.claims.statement import Statement
from labcal.run.descriptions import parse_yaml, validate_description


def test_eight_claims_with_enough_pairs() -> None:
    plan = claims_plan()
    assert list(plan.claims) == [f"C{n}" for n in range(1, 9)]
    for claim in plan.claims.values():
        assert all((one.seeds or claim.seeds) >= 10 for one in claim.comparisons)


def test_a_comparison_states_one_thing() -> None:
    with pytest.raises(ValueError, match="one of"):
        Comparison(where="x", of="a", over="b", at_most=1.0, more_than=1.0)
    with pytest.raises(ValueError, match="one of"):
        Comparison(where="x", of="a", over="b")
    one = Comparison(where="x", of="a", over=2.0, equivalent=1.5)
    assert (one.statement, one.factor) == (Statement.EQUIVALENT, 1.5)


def test_arms_are_known_and_used() -> None:
    arm = Arm(data=ArmData.PLANE, points=10)
    stated = Comparison(where="x", of="a", over="b", at_most=1.0)
    with pytest.raises(ValueError, match="no arm 'b'"):
        Claim(claim="", expected="", seeds=10, arms={"a": arm}, comparisons=(stated,))
    with pytest.raises(ValueError, match="no comparison uses the arms c"):
        Claim(claim="", expected="", seeds=10, arms={"a": arm, "b": arm, "c": arm}, comparisons=(stated,))


def test_a_wrong_key_of_a_plan_is_named() -> None:
    with pytest.raises(InputError, match="amendet"):
        validate_description(Plan, "plan", "x", parse_yaml("{format: 1, amendet: [], claims: {}}", "x"))
