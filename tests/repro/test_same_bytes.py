"""The same bytes from serial, two processes and a cluster, also when parts of the cluster are killed."""

import os
import signal
import subprocess
import sys
import time
from collections.abc import Callable
from pathlib import Path

import pytest

from labcal.run.case import Fault
from labcal.run.executor import open_executor
from labcal.run.progress import NoProgress
from labcal.run.sweep import sweep
from repro.processes import ROOT, DaskProcesses, kill, wait_for
from repro.summing import Figures, Sum, begun, document, summed, sums

COUNT = 60


def swept(cases: list[Sum], folder: Path, workers: int = 1, scheduler: str | None = None) -> str:
    with open_executor(workers, scheduler) as executor:
        return document(sweep(cases, summed, Figures, folder, executor, NoProgress()))


def test_the_same_bytes_from_serial_processes_and_a_cluster_one_of_whose_workers_lacks_labcal(
    cluster: DaskProcesses, tmp_path: Path, notes: Path, caplog: pytest.LogCaptureFixture
) -> None:
    cluster.start_worker(without_labcal=True)
    serial = swept(sums(24), tmp_path / "serial")
    processes = swept(sums(24), tmp_path / "processes", workers=2)
    with open_executor(1, cluster.address) as executor:
        wait_for(lambda: executor.window == 16 and "left out" in caplog.text)  # all three were looked at
        cases = sums(24, notes)
        clustered = document(sweep(cases, summed, Figures, tmp_path / "cluster", executor, NoProgress()))
    assert serial == processes == clustered
    assert begun(notes) == {case.key: 1 for case in cases}
    told = [record.getMessage() for record in caplog.records if record.name.startswith("labcal")]
    assert len(told) == 1
    assert "is left out: labcal cannot be loaded there" in told[0]
    assert "No module named" in told[0]


class At(NoProgress):
    """Does something when so many cases are done."""

    def __init__(self, moments: dict[int, Callable[[], object]]) -> None:
        self._moments, self._done = moments, 0

    def advance(self, steps: int = 1) -> None:
        self._done += steps
        if self._done in self._moments:
            self._moments[self._done]()


def same_in_spite_of(
    moments: dict[int, Callable[[], object]], cluster: DaskProcesses, tmp_path: Path, notes: Path
) -> dict[str, int]:
    """Sweep while something is done to a cluster, and return how often each case was begun."""
    cases = sums(COUNT, notes, pause_s=0.1)
    with open_executor(1, cluster.address) as executor:
        outcomes = sweep(cases, summed, Figures, tmp_path / "harmed", executor, At(moments))
    assert [one.key for one in outcomes] == [case.key for case in cases]
    assert document(outcomes) == swept(sums(COUNT), tmp_path / "serial")
    files = sorted(path.name for path in (tmp_path / "harmed").iterdir())
    assert files == sorted(f"{case.key}.json" for case in cases)
    return begun(notes)


@pytest.mark.slow
def test_killed_workers_change_nothing(cluster: DaskProcesses, tmp_path: Path, notes: Path) -> None:
    def replace(number: int) -> None:
        kill(cluster.workers[number])
        cluster.start_worker()

    times = same_in_spite_of({5: lambda: replace(0), 20: lambda: replace(1)}, cluster, tmp_path, notes)
    again = {key: count for key, count in times.items() if count > 1}
    assert len(times) == COUNT
    assert 1 <= len(again) <= 4  # of each the one that it was at, and one whose result was not fetched yet


@pytest.mark.slow
def test_a_cluster_that_loses_all_of_its_workers_goes_on_with_new_ones(
    cluster: DaskProcesses, tmp_path: Path, notes: Path
) -> None:
    def replace() -> None:
        for worker in cluster.workers[:2]:
            kill(worker)
        cluster.start_worker()

    assert len(same_in_spite_of({10: replace}, cluster, tmp_path, notes)) == COUNT


@pytest.mark.slow
def test_a_scheduler_that_is_killed_and_started_again_changes_nothing(
    cluster: DaskProcesses, tmp_path: Path, notes: Path
) -> None:
    def restart() -> None:
        kill(cluster.scheduler)
        cluster.start_scheduler()
        for worker in cluster.workers[:2]:
            worker.wait(60)  # Dask's own end when they lose their scheduler
            cluster.start_worker()

    times = same_in_spite_of({10: restart}, cluster, tmp_path, notes)
    assert len(times) == COUNT
    assert sum(times.values()) - COUNT <= 16  # what had been sent and not come back


@pytest.mark.slow
def test_a_worker_without_labcal_that_joins_in_mid_sweep_does_no_case(
    cluster: DaskProcesses, tmp_path: Path, notes: Path, caplog: pytest.LogCaptureFixture
) -> None:
    def join() -> None:
        cluster.start_worker(without_labcal=True)
        wait_for(lambda: "left out" in caplog.text)

    times = same_in_spite_of({10: join}, cluster, tmp_path, notes)
    assert times == {f"sum-{seed}": 1 for seed in range(COUNT)}
    assert caplog.text.count("left out") == 1


@pytest.mark.slow
def test_a_case_that_ends_every_worker_has_a_reason_and_the_others_results(tmp_path: Path) -> None:
    cases = [*sums(5), Sum(5, ends_process=True), *sums(20)[6:]]
    with open_executor(2, "local") as executor:
        outcomes = sweep(cases, summed, Figures, tmp_path / "cluster", executor, NoProgress())
    assert [one.key for one in outcomes if one.result is None] == ["sum-5"]
    assert outcomes[5].fault is Fault.MACHINE
    expected = swept([case for case in cases if not case.ends_process], tmp_path / "serial")
    assert document([one for one in outcomes if one.result is not None]) == expected


SWEEP = """
import sys
from pathlib import Path
from repro.summing import Figures, document, summed, sums
from labcal.run.case import Fault
from labcal.run.executor import open_executor
from labcal.run.progress import NoProgress
from labcal.run.sweep import sweep

if __name__ == "__main__":
    folder, workers, scheduler, count, pause_s = sys.argv[1:]
    folder = Path(folder)
    cases = sums(int(count), folder / "notes", float(pause_s))
    with open_executor(int(workers), scheduler or None) as executor:
        outcomes = sweep(cases, summed, Figures, folder / "cases", executor, NoProgress())
    (folder / "document.json").write_text(document(outcomes))
"""


def start_sweep(folder: Path, workers: int, scheduler: str | None) -> subprocess.Popen[str]:
    script = folder / "script.py"
    script.write_text(SWEEP)
    path = os.pathsep.join((str(ROOT), str(ROOT / "tests")))
    words = (str(folder), str(workers), scheduler or "", str(COUNT), "0.1")
    return subprocess.Popen(
        [sys.executable, str(script), *words], env={**os.environ, "PYTHONPATH": path},
        stderr=subprocess.PIPE, text=True,
    )  # fmt: skip


def done(folder: Path) -> dict[str, int]:
    """Return the result files by name, each with a number that changes when it is written anew."""
    files = (folder / "cases").glob("sum-*.json") if (folder / "cases").is_dir() else ()
    return {path.name: path.stat().st_ino for path in files}


@pytest.mark.slow
@pytest.mark.parametrize("where", ["processes", "cluster", "local"])
def test_a_main_process_that_is_killed_resumes_with_what_is_missing(
    where: str, cluster: DaskProcesses, tmp_path: Path, notes: Path
) -> None:
    scheduler = {"processes": None, "cluster": cluster.address, "local": "local"}[where]
    first = start_sweep(tmp_path, 2, scheduler)
    wait_for(lambda: len(done(tmp_path)) >= 15)
    first.send_signal(signal.SIGKILL)
    first.communicate()
    time.sleep(1.0)  # what a worker had begun ends, and is not written
    before = done(tmp_path)
    assert 15 <= len(before) < COUNT
    again = start_sweep(tmp_path, 2, scheduler)
    assert again.communicate(timeout=120)[1] == ""
    assert again.returncode == 0
    after = done(tmp_path)
    assert {name: after[name] for name in before} == before  # none was done again
    assert len(after) == COUNT
    assert sum(begun(notes).values()) - COUNT <= 16
    assert (tmp_path / "document.json").read_text() == swept(sums(COUNT), tmp_path / "serial")


@pytest.mark.slow
def test_an_interrupt_cancels_what_is_not_begun_and_keeps_what_is_done(
    cluster: DaskProcesses, tmp_path: Path, notes: Path
) -> None:
    process = start_sweep(tmp_path, 1, cluster.address)
    wait_for(lambda: len(done(tmp_path)) >= 10)
    process.send_signal(signal.SIGINT)
    assert "KeyboardInterrupt" in process.communicate(timeout=30)[1]
    time.sleep(1.5)  # what was begun comes to its end
    count = sum(begun(notes).values())
    assert len(done(tmp_path)) >= 10
    assert count <= len(done(tmp_path)) + 16
    time.sleep(1.0)
    assert sum(begun(notes).values()) == count


@pytest.mark.slow
def test_a_worker_with_several_threads_does_one_case_at_a_time_with_one_thread(
    cluster: DaskProcesses, tmp_path: Path
) -> None:
    for worker in cluster.workers:
        kill(worker)
    cluster.start_worker("--nthreads", "4")
    assert swept(sums(24), tmp_path / "c", scheduler=cluster.address) == swept(sums(24), tmp_path / "s")
