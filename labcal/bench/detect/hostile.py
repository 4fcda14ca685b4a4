"""Thousands of damaged and hostile inputs, each of which must give a result or a reason."""

from collections import Counter
from concurrent.futures import ThreadPoolExecutor
from dataclasses import dataclass
from pathlib import Path
from tempfile import TemporaryDirectory

from labcal.bench.detect.hostile_encoding import TARGET, dots_picture
from labcal.bench.detect.hostile_files import hostile_file
from labcal.bench.detect.limited_process import LimitedProcess, Limits, ProcessResult
from labcal.bench.groups import Bench, Findings
from labcal.report.bench import Figure, at_most
from labcal.run.machine import usable_cores
from labcal.run.made import make_folder
from labcal.run.outputs import write_file
from labcal.run.progress import Progress
from labcal.run.tables import table_text

INPUTS, QUICK_INPUTS = 10_000, 500
SECONDS = 5.0
MEMORY_BYTES = 2**30
MOST_PROCESSES = 4
_EXPECTED = frozenset({"result", "reason"})


@dataclass(frozen=True)
class HostileOutcome:
    """The result of one input."""

    name: str
    found: ProcessResult


def hostile_findings(bench: Bench) -> Findings:
    """Return the numbers of inputs that crash, hang or take too much memory.

    ``hostile.csv`` lists the result of every input, and ``hostile`` keeps those that failed.
    """
    count = QUICK_INPUTS if bench.quick else INPUTS
    outcomes = hostile_outcomes(count, bench.seed, bench.folder / "hostile", bench.progress)
    lines = [[one.name, one.found.ending, one.found.words] for one in outcomes]
    write_file(bench.folder / "hostile.csv", table_text(("input", "ending", "words"), lines), force=True)
    endings = Counter(one.found.ending for one in outcomes)
    memory = max(one.found.memory_mib for one in outcomes)
    name = f"{count} hostile inputs"
    return Findings(
        [
            at_most(f"{name}: crashes and errors that nobody raised", endings["crash"] + endings["error"], 0),
            at_most(f"{name}: longer than {SECONDS:g} s", endings["hang"], 0),
            at_most(f"{name}: refused for want of memory", endings["memory"], 0),
            at_most(f"{name}: most memory, MiB", memory, MEMORY_BYTES / 2**20),
        ],
        [Figure(name=f"{name}: with a result", value=endings["result"])],
    )


def hostile_outcomes(count: int, seed: int, kept: Path, progress: Progress) -> list[HostileOutcome]:
    """Measure hostile inputs in processes with limits.

    Parameters
    ----------
    count : int
    seed : int
    kept : Path
        A folder for inputs that failed.
    progress : Progress
        Notified of every input.
    """
    progress.start("hostile inputs", count)
    processes = min(MOST_PROCESSES, usable_cores())
    outcomes: list[HostileOutcome] = []
    with TemporaryDirectory() as home, ThreadPoolExecutor(processes) as pool:
        parts = [
            pool.submit(_some, range(first, count, processes), seed, (Path(home), kept), progress)
            for first in range(processes)
        ]
        for part in parts:
            outcomes += part.result()
    return sorted(outcomes, key=lambda outcome: outcome.name)


def _some(numbers: range, seed: int, folders: tuple[Path, Path], progress: Progress) -> list[HostileOutcome]:
    """Measure some of the inputs in one process after another."""
    home, kept = folders
    outcomes = []
    with LimitedProcess(TARGET, dots_picture(), Limits(MEMORY_BYTES, SECONDS)) as process:
        for number in numbers:
            path = hostile_file(number, seed, home)
            found = process.measure(path)
            outcomes.append(HostileOutcome(path.name, found))
            if found.ending not in _EXPECTED and path.is_file():
                make_folder(kept)
                write_file(kept / path.name, path.read_bytes(), force=True)
            if path.is_dir():
                path.rmdir()
            else:
                path.unlink()
            progress.advance()
    return outcomes
