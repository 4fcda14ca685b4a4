"""Plans: those that ship, changes to them, and refusals before anything begins."""

import json
import time
from dataclasses import replace
from pathlib import Path

import pytest

from labcal.bench.distortion.bench import bench_distortion
from labcal.bench.distortion.case import Source
from labcal.bench.distortion.cost import announcement, expected_seconds, plain_time
from labcal.bench.distortion.plan import load_plan
from labcal.bench.distortion.requested_plan import plan_of
from labcal.bench.settings import BenchSettings
from labcal.errors import InputError
from labcal.run.progress import NoProgress


def test_the_quick_plan_is_as_wide_as_the_issue_asks() -> None:
    plan = load_plan("quick")
    widths = (plan.methods, plan.families, plan.strengths, plan.noise_px, plan.points)
    assert all(len(levels) >= least for levels, least in zip(widths, (5, 4, 4, 2, 3), strict=True))
    assert plan.seeds >= 3
    assert {"mlp", "hybrid", "bundle", "two-plane"} < set(plan.methods)
    assert plan.case_count == len(plan.cases(0)) == len({case.key for case in plan.cases(0)})


def test_faults_are_measured_in_reference_cells_of_the_plan_and_after_all_others() -> None:
    plan = load_plan("quick", ["faults=pitch,bend-2"])
    faulty = [case for case in plan.cases(5) if case.cell.fault != "none"]
    assert [case.cell.fault for case in faulty] == ["pitch-0.001", "bend-2"]
    assert {case.seed for case in faulty} == {5}
    assert [case for case in plan.cases(5) if case.cell.source is Source.SIMULATED][-2:] == faulty
    reference = {replace(case.cell, fault="none") for case in faulty}
    assert reference < set(plan.cells())
    assert (faulty[0].cell.noise_px, faulty[0].cell.points) == (min(plan.noise_px), max(plan.points))
    assert len({case.key for case in plan.cases(5)}) == plan.case_count
    assert load_plan("quick", ["faults=none"]).case_count == plan.case_count - 2


def test_reference_cells_follow_changes_of_the_levels() -> None:
    """Quick measures faults in one family; where that is not measured, in those that are."""
    water = load_plan("quick", ["families=water,wavy-pane", "strengths=1,0.3,0.5"], seeds=1)
    cells = list(water.fault_cells())
    assert [cell.family for cell in cells[:: len(water.faults.kinds)]] == ["water", "wavy-pane"]
    assert {cell.strength for cell in cells} == {0.5}
    assert load_plan("quick", ["families=water,brown"]).faults.families == ("brown",)
    assert list(load_plan("quick", ["layout=volume"]).fault_cells()) == []


def test_levels_methods_and_seeds_are_changed() -> None:
    plan = load_plan(
        "quick", ["strengths=0, 0.5", "layout=volume"], ["sklearn.svm:SVR", "dlt", "sklearn.svm:SVR"], seeds=2
    )
    assert plan.strengths == (0.0, 0.5)
    assert plan.layout == ("volume",)
    assert plan.methods == (*load_plan("quick").methods, "sklearn.svm:SVR")
    assert {case.seed for case in plan.cases(7)} == {7, 8}
    assert plan.sha256 != load_plan("quick").sha256 == load_plan("quick").sha256
    assert set(plan.settings) == {"mlp"}
    assert load_plan("quick", ["methods=dlt"]).settings == {}


@pytest.mark.parametrize(
    ("settings", "said"),
    [
        ({"plan": "quik", "quick": False}, "Did you mean 'quick'"),
        ({"plan": "", "quick": False}, "There is no plan named ''"),
        ({"plan": "full"}, "both name a plan"),
        ({"overrides": ("strengths=0", "strengths=1")}, "changes 'strengths' twice"),
        ({"overrides": ("strength=1",)}, "Did you mean 'strengths'"),
        ({"overrides": ("seeds=3",)}, "seeds are no levels. Give `seeds`"),
        ({"overrides": ("families=watre",)}, "Did you mean 'water'"),
        ({"overrides": ("layout=plane",)}, "did you mean 'planes'"),
        ({"overrides": ("measured=beyond",)}, "none of 'within' or 'outside'"),
        ({"overrides": ("strengths=0,1.5",)}, "'1.5' should be at most 1"),
        ({"overrides": ("strengths",)}, "takes a factor and its levels"),
        ({"overrides": ("points=60,60",)}, "a level stands twice"),
        ({"overrides": ("strengths=0.1234567,0.1234568",)}, "a level stands twice"),
        ({"overrides": ("methods=hybird",)}, "Did you mean 'hybrid'"),
        ({"overrides": ("faults=pich-0.01",)}, "Did you mean 'pitch'"),
        ({"overrides": ("faults=pitch-2",)}, "above 0 and at most 0.5"),
        ({"overrides": ("faults=pitch,pitch-1e-3",)}, "a fault stands twice"),
        ({"overrides": ("layout=volume", "faults=bend-1")}, "of a board on planes, but the layout is volume"),
        ({"methods": ("no_such_package:Class",)}, "There is no module 'no_such_package'"),
        ({"seeds": 0}, "`seeds` must be at least 1"),
    ],
)
def test_what_cannot_be_measured_is_refused_at_once(
    settings: dict[str, object], said: str, tmp_path: Path
) -> None:
    with pytest.raises(InputError, match=said):
        bench_distortion(tmp_path / "out", BenchSettings(**({"quick": True} | settings)), NoProgress())  # type: ignore[arg-type]
    assert not any(tmp_path.iterdir())


@pytest.mark.parametrize(
    ("text", "said"),
    [
        ("settings: {mpl: {max_epochs: 3}}", "settings of 'mpl'"),
        ("settings: {mlp: {max_epoch: 3}}", "Did you mean 'max_epochs'"),
        ("familes: [brown]", "the nearest one is 'families'"),
        ("faults: {kinds: [bend-1], strengths: [0.5]}", r"names 0.5 of `strengths`, which the plan does not"),
        ("faults: {kinds: [bend-1], familes: [brown]}", "the nearest one is 'families'"),
        ("faults: [bent-1]", "Did you mean 'bend'"),
        ("faults: {kinds: [bend-1], families: [brown, brown]}", "faults.families: a level stands twice"),
        ("faults: {kinds: [bend-1], seeds: true}", "faults.seeds: true is no number"),
        ("faults: bend-1", "'bend-1' should be a mapping of keys to values"),
        ("protocols: z-travel", r"'z-travel' should be a list, in brackets"),
        ("rendered: {spp: true}", "rendered.spp: true is no number"),
        ("rendered: {strengths: [false]}", "false is no number"),
        ("settings: {dlt: {lens: auto}}", "'dlt' has no settings, but 'lens' of it is given"),
        ("settings: {mlp: {max_epochs: many}}", "'max_epochs' of mlp is a whole number, by default 5000"),
        ("settings: {mlp: {max_epochs: true}}", "but True is given"),
        ("settings: {mlp: {goal: true}}", "'goal' of mlp is a number"),
        ("settings: {mlp: {max_epochs: 2.5}}", "but 2.5 is given"),
    ],
)
def test_a_plan_of_ones_own_is_checked(text: str, said: str, tmp_path: Path) -> None:
    plan = load_plan("quick", ["families=brown", "methods=dlt,mlp"])
    file = tmp_path / "plan.yaml"
    own = plan.model_dump(mode="json", exclude={"settings", "description", "faults", "protocols", "rendered"})
    file.write_text("\n".join(f"{key}: {value}" for key, value in own.items()) + "\n" + text + "\n")
    with pytest.raises(InputError, match=said):
        plan_of(BenchSettings(plan=str(file)))


@pytest.mark.parametrize("factor", ["strengths", "noise_px", "points", "seeds", "tests"])
def test_a_truth_value_is_no_number(factor: str, tmp_path: Path) -> None:
    content = load_plan("quick").model_dump(mode="json")
    content[factor] = [True] if isinstance(content[factor], list) else True
    file = tmp_path / "plan.yaml"
    file.write_text(json.dumps(content))
    with pytest.raises(InputError, match=rf"{factor}.*: true is no number"):
        load_plan(str(file))


@pytest.mark.parametrize(
    ("seeds", "said"), [(1, "1 case of 1 method: about"), (2, "2 cases of 1 method: about")]
)
def test_the_announcement_counts_in_words(seeds: int, said: str) -> None:
    assert announcement(load_plan("smallest", ["methods=dlt"], seeds=seeds)).startswith(said)


def test_the_time_of_a_quick_method_holds_the_fit_of_the_surrogate() -> None:
    dlt, both = (
        load_plan("smallest", [f"methods={names}", "points=4000"]) for names in ("dlt", "dlt,hybrid")
    )
    assert expected_seconds(dlt, 1) == expected_seconds(both, 1) > 100.0


def test_a_second_is_one() -> None:
    assert (plain_time(1.2), plain_time(2.0)) == ("1 second", "2 seconds")


def test_a_whole_number_is_a_setting_that_is_a_number(tmp_path: Path) -> None:
    content = load_plan("quick", ["methods=mlp"]).model_dump(mode="json")
    file = tmp_path / "plan.yaml"
    file.write_text(json.dumps(content | {"settings": {"mlp": {"goal": 0, "hidden": "8"}}}))
    assert plan_of(BenchSettings(plan=str(file))).settings == {"mlp": {"goal": 0, "hidden": "8"}}


def test_a_billion_cases_are_refused_with_the_time_that_they_would_take() -> None:
    began = time.monotonic()
    with pytest.raises(InputError, match=r"96,000,000,004 cases of 5 methods: about [\d,]+ years on"):
        plan_of(BenchSettings(quick=True, seeds=10**9))
    assert time.monotonic() - began < 1.0
