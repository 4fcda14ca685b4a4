"""Groups of checks by name, and names of several groups."""

from pathlib import Path

import pytest

from labcal.bench.detect import bench as detect
from labcal.bench.groups import Bench, Findings
from labcal.bench.settings import BenchSettings
from labcal.bench.solve import bench
from labcal.cli import build_parser
from labcal.errors import UnknownNameError
from labcal.run.progress import NoProgress


def test_budget_stands_for_all_that_it_rests_on_and_each_is_measured_once(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    measured: list[str] = []

    def stub(name: str) -> object:
        def findings(_bench: Bench) -> Findings:
            measured.append(name)
            return Findings([], [])

        return findings

    monkeypatch.setattr(bench, "GROUPS", {name: stub(name) for name in bench.GROUPS})
    monkeypatch.setattr(bench, "_OF_MARKS", {name: stub(name) for name in bench._OF_MARKS})
    bench.bench_solve(tmp_path / "some", BenchSettings(groups=("check", "budget")), NoProgress())
    assert sorted(measured) == sorted(bench.TOGETHER["budget"])
    measured.clear()
    bench.bench_solve(tmp_path / "all", BenchSettings(), NoProgress())
    assert measured == list(bench.GROUPS)
    assert not {"diagnose", "guided", "boards"}.intersection(measured)


def test_an_unknown_group_is_refused_with_the_nearest_name(tmp_path: Path) -> None:
    with pytest.raises(UnknownNameError, match="Did you mean 'coverage'"):
        bench.bench_solve(tmp_path / "x", BenchSettings(groups=("covrage",)), NoProgress())
    assert not list(tmp_path.iterdir())


def test_help_names_every_group() -> None:
    (commands,) = build_parser("bench")._subparsers._group_actions  # type: ignore[union-attr]
    text = " ".join(commands.choices["bench"].format_help().split())  # type: ignore[index]
    for group in (*bench.GROUPS, *bench._OF_SHOOTS, *bench.TOGETHER, *detect.GROUPS):
        assert group in text.replace("- ", "-"), group
