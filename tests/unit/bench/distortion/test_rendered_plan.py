"""The section `rendered` of a plan: when it takes part, changes to it, and refusals."""

from pathlib import Path

import pytest

from labcal import pipeline
from labcal.bench.distortion import requested_plan
from labcal.bench.distortion.bench import bench_distortion
from labcal.bench.distortion.case import Source
from labcal.bench.distortion.cost import expected_seconds
from labcal.bench.distortion.plan import load_plan
from labcal.bench.distortion.requested_plan import plan_of
from labcal.bench.settings import BenchSettings
from labcal.cli import main
from labcal.errors import DeviceError, InputError
from labcal.run.progress import NoProgress


@pytest.mark.parametrize("quick", [True, False])
def test_cases_through_pictures_are_measured_only_where_they_are_asked_for(*, quick: bool) -> None:
    without = plan_of(BenchSettings(quick=quick))
    asked = plan_of(BenchSettings(quick=quick, rendered=True))
    assert load_plan("quick" if quick else "full").rendered is not None
    assert without.rendered is None
    assert asked.rendered is not None
    assert len(asked.rendered.families) >= 2
    assert len(asked.rendered.strengths) >= 4
    cases = asked.cases(3)
    assert len(cases) == asked.case_count == without.case_count + asked.rendered.case_count
    assert len({case.key for case in cases}) == len(cases)
    assert cases[: without.case_count] == without.cases(3)
    assert {case.cell.source for case in cases[without.case_count :]} == {Source.RENDERED}
    assert {case.seed for case in cases[without.case_count :]} == set(range(3, 3 + asked.rendered.seeds))
    assert expected_seconds(asked, 2) > expected_seconds(without, 2)


def test_the_section_is_changed_by_the_names_of_its_keys() -> None:
    changes = ("rendered.strengths=0, 1", "rendered.families=wavy-pane", "rendered.views=3")
    plan = plan_of(BenchSettings(quick=True, rendered=True, overrides=(*changes, "rendered.seeds=2")))
    assert plan.rendered is not None
    assert plan.rendered.strengths == (0.0, 1.0)
    assert plan.rendered.families == ("wavy-pane",)
    assert plan.rendered.points == 3 * 130
    assert plan.rendered.picture_count == 2 * (3 + 2)
    assert plan.rendered.case_count == 4
    assert plan.families == load_plan("quick").families


def test_a_plan_of_ones_own_needs_no_section(tmp_path: Path) -> None:
    file = tmp_path / "plan.yaml"
    own = load_plan("quick").model_dump(mode="json", exclude={"settings", "description", "rendered"})
    file.write_text("\n".join(f"{key}: {value}" for key, value in own.items()) + "\n")
    plan = plan_of(BenchSettings(plan=str(file), rendered=True, overrides=("rendered.spp=8",)))
    assert plan.rendered is not None
    assert (plan.rendered.spp, plan.rendered.views) == (8, 4)


@pytest.mark.parametrize(
    ("settings", "said"),
    [
        ({"overrides": ("rendered.strenghts=1",)}, "Did you mean 'rendered.strengths'"),
        ({"overrides": ("rendered.families=watre",)}, "Did you mean 'water'"),
        ({"overrides": ("rendered.strengths=2",)}, "should be at most 1"),
        ({"overrides": ("rendered.views=1",)}, "at least 2"),
        ({"overrides": ("rendered.spp=many",)}, "rendered.spp"),
        ({"overrides": ("rendered.seeds=1",), "rendered": False}, "give `rendered=True`, too"),
    ],
)
def test_what_cannot_be_rendered_is_refused_at_once(
    settings: dict[str, object], said: str, tmp_path: Path
) -> None:
    wanted = {"quick": True, "rendered": True, **settings}
    with pytest.raises(InputError, match=said):
        bench_distortion(tmp_path / "out", BenchSettings(**wanted), NoProgress())  # type: ignore[arg-type]
    assert not any(tmp_path.iterdir())


def test_a_machine_that_cannot_render_is_told_before_anything_begins(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    def no_library() -> Path:
        raise DeviceError("no LLVM")

    monkeypatch.setattr(requested_plan, "ensure_llvm", no_library)
    with pytest.raises(DeviceError, match="no LLVM"):
        bench_distortion(tmp_path / "out", BenchSettings(quick=True, rendered=True), NoProgress())
    assert not any(tmp_path.iterdir())
    assert plan_of(BenchSettings(quick=True)).rendered is None


def test_other_benchmarks_render_nothing_of_the_kind(tmp_path: Path) -> None:
    with pytest.raises(InputError, match="`rendered` goes with 'bench distortion'"):
        pipeline.bench("solve", tmp_path / "out", BenchSettings(rendered=True))


def test_the_command_line_speaks_of_its_option(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    words = ["bench", "distortion", "--quick", "--set", "rendered.spp=8", "-o", str(tmp_path / "out")]
    assert main(words) == 2
    assert "give --rendered, too" in " ".join(capsys.readouterr().err.split())
