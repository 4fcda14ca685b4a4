"""The group's own workings; its figures are measured when the command runs."""

from pathlib import Path

import pytest

from labcal.bench.groups import Bench
from labcal.bench.solve import training
from labcal.run.progress import NoProgress


def test_without_the_other_software_its_checks_are_left_out_and_named(
    monkeypatch: pytest.MonkeyPatch, tmp_path: Path
) -> None:
    monkeypatch.setattr(training, "find_spec", lambda _: None)
    monkeypatch.setattr(training, "MEMBERS", 2)
    monkeypatch.setattr(training, "PATIENCE", 1)
    found = training.training_findings(Bench(True, 0, tmp_path, NoProgress()))
    assert [check.limit for check in found.checks] == [0.5, 6.0, 6.0]
    assert all(check.value > 0 for check in found.checks)
    assert "a batch of 2, an ensemble" in found.checks[-1].name
    assert "extra 'bench'" in found.notes[0]


def test_calls_are_timed_in_turn() -> None:
    order: list[str] = []
    least = training._least(2, lambda: order.append("a"), lambda: order.append("b"))
    assert order == ["a", "b", "a", "b"]
    assert len(least) == 2
    assert min(least) >= 0.0
