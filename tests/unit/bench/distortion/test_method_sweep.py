"""Methods of a user's that end the process which runs them."""

import csv
import sys
from collections.abc import Callable
from concurrent.futures import Executor, Future
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import pytest
from pydantic import BaseModel

from labcal import pipeline
from labcal.bench.distortion import bench
from labcal.bench.distortion.method_sweep import MethodWork, sweep_methods
from labcal.bench.method_executor import open_method_executor
from labcal.errors import DeviceError, WorkerError, WorkersEndError
from labcal.run.case import CaseOutcome, Fault
from labcal.run.executor import SerialExecutor
from labcal.run.pool import WorkerPool
from labcal.run.progress import NoProgress


@dataclass(frozen=True)
class Sums:
    number: int
    methods: tuple[str, ...]

    @property
    def key(self) -> str:
        return f"case-{self.number}"


class Row(BaseModel):
    method: str
    value: int = 0
    reason: str | None = None


class Rows(BaseModel):
    methods: tuple[Row, ...]


def summed(case: Sums) -> Rows:
    rows = [Row(method=name, value=case.number + len(name)) for name in case.methods]
    return Rows(methods=(Row(method="oracle"), *rows))


WORK: MethodWork[Sums, Rows] = MethodWork(summed, Rows, Row)
METHODS = ("mine:Good", "hybrid", "dlt", "mine:Bad")


class Ending(Executor):
    """Cases of some numbers with a certain method end their processes."""

    def __init__(self, method: str, numbers: set[int]) -> None:
        self.method, self.numbers = method, numbers
        self.tried: list[tuple[int, tuple[str, ...]]] = []

    def submit(self, fn: Callable[..., Any], /, *args: Any, **kwargs: Any) -> Future[Any]:  # noqa: ANN401 -- as of the base class
        case: Sums = args[1]
        self.tried.append((case.number, case.methods))
        if self.method in case.methods and case.number in self.numbers:
            future: Future[Any] = Future()
            future.set_exception(WorkerError("with exit status 3"))
            return future
        return SerialExecutor().submit(fn, *args, **kwargs)


def swept(folder: Path, executor: Executor, methods: tuple[str, ...] = METHODS) -> list[CaseOutcome[Rows]]:
    cases = [Sums(number, methods) for number in range(3)]
    return sweep_methods(cases, WORK, folder / "cases", executor, NoProgress())


def test_a_method_that_ends_its_process_costs_its_own_rows_alone(tmp_path: Path) -> None:
    plain = swept(tmp_path / "plain", SerialExecutor())
    executor = Ending("mine:Bad", {1})
    found = swept(tmp_path / "ending", executor)
    assert [found[0].result, found[2].result] == [plain[0].result, plain[2].result]
    usual, ended = plain[1].result, found[1].result
    assert usual is not None
    assert ended is not None
    assert ended.methods[:-1] == usual.methods[:-1]
    assert [row.method for row in ended.methods] == ["oracle", *METHODS]
    reason = "Each worker process that tried this case ended, the last one alone: with exit status 3."
    assert ended.methods[-1] == Row(method="mine:Bad", reason=reason)
    assert executor.tried[3:] == [
        (1, ("hybrid", "dlt")),
        (1, ("hybrid", "mine:Good")),
        (1, ("hybrid", "mine:Bad")),
    ]
    again = Ending("mine:Bad", {1})
    assert swept(tmp_path / "ending", again) == found
    assert again.tried == [(1, METHODS), (1, ("hybrid", "mine:Bad"))]  # others are kept


def test_a_case_that_ends_its_processes_whatever_is_measured_keeps_that_reason(tmp_path: Path) -> None:
    executor = Ending("mine:Bad", {1})
    found = swept(tmp_path, executor, ("mine:Bad",))
    assert found[1].result is None
    assert found[1].fault is Fault.MACHINE
    assert len(executor.tried) == 3  # one method alone has no parts
    executor = Ending("dlt", {1})  # methods of labcal are not measured apart from each other
    assert swept(tmp_path / "labcal", executor, ("hybrid", "dlt"))[1].result is None
    assert len(executor.tried) == 3


class AllEnding(Executor):
    """No process lives."""

    def submit(self, _fn: Callable[..., Any], /, *_: Any, **_named: Any) -> Future[Any]:  # noqa: ANN401 -- as of the base class
        future: Future[Any] = Future()
        future.set_exception(WorkersEndError(5, "crashed with SIGSEGV"))
        return future


def test_where_all_processes_end_the_methods_of_the_user_are_named(tmp_path: Path) -> None:
    said = "first 5 cases .* crashed with SIGSEGV. Probably a method of yours does that: mine:Good, mine:Bad"
    with pytest.raises(DeviceError, match=said):
        swept(tmp_path, AllEnding())
    with pytest.raises(WorkersEndError, match="labcal doctor"):
        swept(tmp_path / "labcal", AllEnding(), ("dlt",))


def test_a_method_of_ones_own_has_a_process_of_its_own_with_one_worker_too() -> None:
    with open_method_executor(1, None, ("dlt", "mine:Good")) as executor:
        assert isinstance(executor, WorkerPool)
    with open_method_executor(1, None, ("dlt",)) as executor:
        assert isinstance(executor, SerialExecutor)


@pytest.mark.slow
def test_a_method_that_ends_the_process_is_a_row_with_its_reason(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    code = "import os\nclass Ends:\n  def fit(self, X, Y): os._exit(3)\n  def predict(self, X): return X\n"
    (tmp_path / "ending_method.py").write_text(code)
    monkeypatch.setattr(sys, "path", [str(tmp_path), *sys.path])
    monkeypatch.setattr(bench, "usable_cores", lambda: 1)
    plan = ("families=brown", "strengths=0.4", "noise_px=0.1", "points=60", "methods=dlt", "faults=none")
    for name, methods in (("with", ("ending_method:Ends",)), ("without", ())):
        settings = pipeline.BenchSettings(quick=True, overrides=plan, seeds=1, methods=methods)
        pipeline.bench("distortion", tmp_path / name, settings)
    lines, others = [
        list(csv.DictReader((tmp_path / name / "results.csv").read_text(encoding="utf-8").splitlines()))
        for name in ("with", "without")
    ]
    assert lines[:2] == others
    assert {line["method"] for line in lines[2:]} == {"ending_method:Ends"}
    assert all("with exit status 3" in line["reason"] for line in lines[2:])
