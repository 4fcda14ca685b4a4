"""Claims from the figures of their runs."""

import numpy as np
import pytest

from labcal.paper.claims.arm_run import ArmFigures
from labcal.paper.claims.outcome import claim_results, claim_runs
from labcal.paper.claims.pictured import needed_shoots
from labcal.paper.claims.plan import Arm, ArmData, Claim, Comparison, claims_plan
from labcal.rng import generator

ARM = Arm(data=ArmData.PLANE, points=250)


def _claim(*comparisons: Comparison) -> Claim:
    return Claim(claim="a", expected="b", seeds=10, arms={"one": ARM, "other": ARM}, comparisons=comparisons)


def _figures(ratio: float) -> dict[str, ArmFigures]:
    """Figures of ten seeds, which differ widely between seeds and by one ratio within."""
    random = generator(0, "test outcome")
    found = {}
    for seed in range(10):
        other = 10.0 ** random.normal(0.0, 2.0)
        one = ratio * other * 10.0 ** random.normal(0.0, 0.01)
        for name, rmse in (("one", one), ("other", other)):
            found[f"C1-{name}-{seed}"] = ArmFigures(rmse_mm=rmse, further_rmse=None, epochs=None)
    return found


def test_pairs_show_a_ratio_that_seeds_hide() -> None:
    claim = _claim(Comparison(where="x", of="one", over="other", at_most=1.25))
    (found,) = claim_results({"C1": claim}, _figures(1.5), None)
    assert found.verdict == "does not hold"
    assert found.effect == pytest.approx(1.5, rel=0.03)
    assert found.interval[0] < 1.5 < found.interval[1]
    assert found.p == pytest.approx(2 / 2**10)
    (found,) = claim_results({"C1": claim}, _figures(1.1), None)
    assert (found.verdict, found.where) == ("holds", ())


def test_where_a_claim_holds_is_said() -> None:
    claim = _claim(
        Comparison(where="here", of="one", over="other", at_most=2.0),
        Comparison(where="there", of="one", over="other", equivalent=1.25),
    )
    (found,) = claim_results({"C1": claim}, _figures(1.5), None)
    assert (found.verdict, found.where) == ("holds only where", ("here",))
    assert [one.supported for one in found.comparisons] == [True, False]


def test_too_few_pairs_decide_nothing_and_have_no_interval() -> None:
    claim = _claim(Comparison(where="x", of="one", over="other", at_most=1.25))
    (found,) = claim_results({"C1": claim}, _figures(1.5), 2)
    assert found.verdict == "undecided"
    assert found.comparisons[0].supported is None
    assert np.isnan(found.interval).all()


def test_exact_solutions_differ_by_no_ratio() -> None:
    claim = _claim(Comparison(where="x", of="one", over="other", equivalent=1.25))
    figures = {
        key: one.model_copy(update={"rmse_mm": 1e-13 if "one" in key else 3e-14})
        for key, one in _figures(1.0).items()
    }
    (found,) = claim_results({"C1": claim}, figures, None)
    assert (found.verdict, found.effect) == ("holds", 1.0)


def test_every_run_is_there_once() -> None:
    claims = claims_plan().claims
    simulated = {name: claim for name, claim in claims.items() if name != "C4"}
    keys = [run.key for run in claim_runs(simulated, {}, None)]
    assert len(keys) == len(set(keys))
    assert "C1-plane-1e-6-11" in keys
    assert "C1-plane-1e-6-12" not in keys
    assert needed_shoots(simulated.values(), None) == []
    assert len(needed_shoots(claims.values(), None)) == 20
    assert len(needed_shoots(claims.values(), 2)) == 4
