"""The time and the memory of sweeps, as ratios measured in one run."""

import os
import subprocess
import sys
import time
from collections.abc import Callable
from contextlib import ExitStack
from dataclasses import dataclass
from pathlib import Path

import pytest
from pydantic import BaseModel

from labcal.run.case import CaseOutcome
from labcal.run.executor import open_executor, open_pool
from labcal.run.progress import NoProgress
from labcal.run.sweep import sweep
from repro.processes import ROOT

pytestmark = pytest.mark.slow
ROUNDS = 8
"""Rounds at most: other work on the machine makes times longer, never shorter, so the least counts."""


@dataclass(frozen=True)
class Loop:
    number: int
    steps: int

    @property
    def key(self) -> str:
        return f"loop-{self.number}"


class Total(BaseModel):
    value: int


def total(case: Loop) -> Total:
    value = case.number
    for _ in range(case.steps):
        value = (value * 1103515245 + 12345) % 2147483648
    return Total(value=value)


def seconds(run: Callable[[Path], list[CaseOutcome[Total]]], folder: Path) -> float:
    began = time.perf_counter()
    outcomes = run(folder)
    assert all(one.result is not None for one in outcomes)
    return time.perf_counter() - began


def test_two_processes_take_less_than_one_and_a_cluster_hardly_more(tmp_path: Path) -> None:
    cases = [Loop(number, 2_000_000) for number in range(24)]
    with ExitStack() as stack:
        executors = {
            "one": stack.enter_context(open_pool(1)),
            "two": stack.enter_context(open_executor(2)),
            "cluster": stack.enter_context(open_executor(2, "local")),
        }
        least = dict.fromkeys(executors, float("inf"))
        for name, executor in executors.items():  # start what is started at the first case
            sweep(
                [Loop(n, 10) for n in range(8)], total, Total, tmp_path / f"w-{name}", executor, NoProgress()
            )
        for number in range(ROUNDS):
            for name, executor in executors.items():
                folder = tmp_path / f"{name}-{number}"
                took = seconds(lambda to, e=executor: sweep(cases, total, Total, to, e, NoProgress()), folder)  # type: ignore[misc]
                least[name] = min(least[name], took)
            if least["one"] >= 1.7 * least["two"] and least["cluster"] <= 1.1 * least["two"]:
                break
    assert least["one"] >= 1.7 * least["two"], least
    assert least["cluster"] <= 1.1 * least["two"], least


EMPTY = """
import resource, sys
from pathlib import Path
from labcal.run.executor import open_executor
from labcal.run.progress import NoProgress
from labcal.run.sweep import sweep
from repro.test_costs import Loop, Total, total

if __name__ == "__main__":
    cases = [Loop(number, 0) for number in range(10_000)]
    with open_executor(2, sys.argv[2] or None) as executor:
        outcomes = sweep(cases, total, Total, Path(sys.argv[1]), executor, NoProgress())
    assert [one.result.value for one in outcomes] == list(range(10_000))
    print(resource.getrusage(resource.RUSAGE_SELF).ru_maxrss)
"""


@pytest.mark.skipif(sys.platform != "linux", reason="the memory is in other units there")
@pytest.mark.parametrize("scheduler", ["", "local"])
def test_ten_thousand_empty_cases_are_queued_done_and_resumed_in_little_memory(
    scheduler: str, tmp_path: Path
) -> None:
    script = tmp_path / "script.py"
    script.write_text(EMPTY)
    environment = {**os.environ, "PYTHONPATH": os.pathsep.join((str(ROOT), str(ROOT / "tests")))}
    folder = tmp_path / "cases"

    def mebibytes() -> float:
        words = [sys.executable, str(script), str(folder), scheduler]
        told = subprocess.run(words, env=environment, stdout=subprocess.PIPE, text=True, check=True)
        return int(told.stdout) / 1024

    assert mebibytes() < 500
    files = {path.name: path.stat().st_ino for path in folder.iterdir()}
    assert len(files) == 10_000
    lost = ("loop-7.json", "loop-9999.json")
    for name in lost:
        (folder / name).unlink()
    assert mebibytes() < 500
    again = {path.name: path.stat().st_ino for path in folder.iterdir()}
    assert {name for name in files if again[name] != files[name]} <= set(lost)
