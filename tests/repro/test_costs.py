"""The time and the memory of sweeps, as ratios measured in one run."""

import os
import subprocess
import sys
import time
from concurrent.futures import Executor
from contextlib import ExitStack, suppress
from dataclasses import dataclass
from pathlib import Path

import psutil
import pytest
from pydantic import BaseModel

from labcal.run.executor import open_executor, open_pool
from labcal.run.progress import NoProgress
from labcal.run.sweep import sweep
from repro.processes import ROOT

pytestmark = pytest.mark.slow
ROUNDS = 3
IDLE = 0.05
"""Share of the processors that others may take on a machine that counts as idle."""


@dataclass(frozen=True)
class Loop:
    number: int
    steps: int

    @property
    def key(self) -> str:
        return f"loop-{self.number}"


class Total(BaseModel):
    value: int
    processor_s: float


def total(case: Loop) -> Total:
    began, value = time.thread_time(), case.number
    for _ in range(case.steps):
        value = (value * 1103515245 + 12345) % 2147483648
    return Total(value=value, processor_s=time.thread_time() - began)


@dataclass(frozen=True)
class Cost:
    """The cost of a sweep."""

    wall_s: float
    overhead: float
    """Processor time of this process and all that it started, over that of the cases, less 1.

    The same loop takes more processor time while others use the machine, and so do the cases in
    the denominator.
    """
    at_once: float
    """Cases in progress, on average."""
    others: float
    """Share of the processors that other work took meanwhile."""


def processor_seconds() -> float:
    here = psutil.Process()
    total = 0.0
    for process in (here, *here.children(recursive=True)):
        with suppress(psutil.NoSuchProcess):
            times = process.cpu_times()
            total += times.user + times.system
    return total


def busy_seconds() -> float:
    """Return the processor time of all processes of the machine."""
    times = psutil.cpu_times()
    return float(times.user + times.system)


def cost(executor: Executor, folder: Path) -> Cost:
    cases = [Loop(number, 1_500_000) for number in range(20)]
    before, all_before, began = processor_seconds(), busy_seconds(), time.perf_counter()
    outcomes = sweep(cases, total, Total, folder, executor, NoProgress())
    wall = time.perf_counter() - began
    assert all(one.result is not None for one in outcomes)
    mine, everyone = processor_seconds() - before, busy_seconds() - all_before
    others = (everyone - mine) / (wall * psutil.cpu_count())
    cases_s = sum(one.result.processor_s for one in outcomes if one.result is not None)
    return Cost(wall, mine / cases_s - 1, sum(one.seconds for one in outcomes) / wall, others)


@pytest.fixture(scope="module")
def costs(tmp_path_factory: pytest.TempPathFactory) -> dict[str, Cost]:
    """The costs with one process, two, and a cluster of two; of each figure the best of some rounds.

    Other work on the machine makes them worse and never better.
    """
    home = tmp_path_factory.mktemp("costs")
    with ExitStack() as stack:
        executors: dict[str, Executor] = {
            "one": stack.enter_context(open_pool(1)),
            "two": stack.enter_context(open_executor(2)),
            "cluster": stack.enter_context(open_executor(2, "local")),
        }
        found: dict[str, list[Cost]] = {}
        for number in range(-1, ROUNDS):  # the first one starts what is started at the first case
            for name, executor in executors.items():
                found.setdefault(name, []).append(cost(executor, home / f"{name}-{number}"))
    return {
        name: Cost(
            min(one.wall_s for one in each[1:]),
            min(one.overhead for one in each[1:]),
            max(one.at_once for one in each[1:]),
            max(one.others for one in each[1:]),
        )
        for name, each in found.items()
    }


def test_two_processes_are_at_work_at_once_and_spend_no_more(costs: dict[str, Cost]) -> None:
    """On a machine that does nothing else they take 1 / 1.7 of the time, then, or less."""
    assert costs["two"].at_once >= 1.7, costs
    assert costs["two"].overhead <= costs["one"].overhead + 0.1, costs


def test_a_cluster_keeps_its_workers_as_busy_as_processes_and_spends_little_more(
    costs: dict[str, Cost],
) -> None:
    assert 1.1 * costs["cluster"].at_once >= costs["two"].at_once, costs
    assert costs["cluster"].overhead <= costs["two"].overhead + 0.1, costs


def test_that_shows_on_the_clock_of_an_idle_machine(costs: dict[str, Cost]) -> None:
    if max(one.others for one in costs.values()) > IDLE:
        pytest.skip("other work on this machine is in the times, too")
    assert costs["one"].wall_s >= 1.7 * costs["two"].wall_s, costs
    assert costs["cluster"].wall_s <= 1.1 * costs["two"].wall_s, costs


EMPTY = """
import sys
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
    # Not ru_maxrss, which begins at the memory of the program that started this one.
    (peak,) = (line for line in Path("/proc/self/status").read_text().splitlines() if "VmHWM" in line)
    print(peak.split()[1])
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
