"""The plan of the claims."""

import json
from pathlib import Path

import pytest

from labcal.errors import InputError
from labcal.paper.claims.plan import Arm, ArmData, Claim, Comparison, Plan, claims_plan, plan_digest
from labcal.paper.claims.statement import Statement
from labcal.run.descriptions import parse_yaml, validate_description

DOCS = Path(__file__).parents[4] / "docs"


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


def test_committed_results_are_of_this_plan() -> None:
    """A change of the plan after its first run asks for a new run, and for an entry under `amended`."""
    results = json.loads((DOCS / "results" / "reproduce.json").read_text(encoding="utf-8"))
    assert results["claims_plan_sha256"] == plan_digest()
    assert [one["claim"] for one in results["claims"]] == list(claims_plan().claims)
    for claim in results["claims"]:
        planned = claims_plan().claims[claim["claim"]]
        assert [one["pairs"] for one in claim["comparisons"]] == [
            planned.pairs(comparison, None) for comparison in planned.comparisons
        ]
