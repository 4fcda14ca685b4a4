"""Mutants fed to the commands in a process of its own, within a time and a memory."""

import multiprocessing
import os
import re
import shutil
import sys
import time
import warnings
from collections.abc import Callable, Iterator
from dataclasses import dataclass, replace
from multiprocessing.connection import Connection
from pathlib import Path
from random import Random

from fuzz.jobs import JOBS, Job
from fuzz.judge import PARTIAL, UNUSABLE, faults_of_ending, faults_of_output
from fuzz.kinds import of_kind
from fuzz.mutators import Mutant

MOST_SECONDS = 5.0
MOST_BYTES = 2**30
_PATIENCE_S = 30.0
"""After which a worker is ended, since it may wait; `MOST_SECONDS` are of its processor's time."""


@dataclass(frozen=True)
class Outcome:
    """What came of one mutant."""

    number: int
    job: str
    what: str
    status: int | None
    seconds: float
    peak_bytes: int
    faults: tuple[str, ...]


def run(seeds: Path, home: Path, seed: int, count: int, first: int = 0) -> Iterator[Outcome]:
    """Yield the outcome of mutants `first` to `first + count` of a seed, each the same in every run.

    Parameters
    ----------
    seeds : Path
        From :func:`fuzz.seeds.make_seeds`; not changed.
    home : Path
        A folder to work in.
    """
    worker = _Worker(seeds, home)
    try:
        for number, job, mutant in mutants(seeds, seed, count, first):
            outcome = worker.outcome(number, job, mutant)
            if outcome.status is None:
                worker.end()
                worker = _Worker(seeds, home)
            yield outcome
    finally:
        worker.end()


def mutants(seeds: Path, seed: int, count: int, first: int = 0) -> Iterator[tuple[int, Job, Mutant]]:
    """Yield the mutants of a seed by number, each with what reads it."""
    bag = [job for job in JOBS for _ in range(job.weight)]
    for number in range(first, first + count):
        rng = Random(f"{seed}-{number}")  # noqa: S311 -- mutations are no secrets
        job = bag[rng.randrange(len(bag))]
        yield number, job, of_kind(job.kind)((seeds / job.file).read_bytes(), rng)


class _Worker:
    """A process that runs one command after another."""

    def __init__(self, seeds: Path, home: Path) -> None:
        context = multiprocessing.get_context("spawn")
        self._here, there = context.Pipe()
        self._process = context.Process(target=_work, args=(there, seeds, home), daemon=True)
        self._process.start()
        there.close()
        if not self._here.poll(900.0):
            raise RuntimeError("The worker does not begin.")
        self._here.recv()

    def outcome(self, number: int, job: Job, mutant: Mutant) -> Outcome:
        """Run the command of a mutant; a status of None where the worker had to be ended."""
        started = time.monotonic()
        self._here.send((job.name, mutant))
        found = Outcome(number, job.name, mutant.what, None, 0.0, 0, ())
        try:
            if self._here.poll(_PATIENCE_S):
                status, seconds, peak, faults = self._here.recv()
                slow = [f"{seconds:.1f} s"] if seconds > MOST_SECONDS else []
                large = [f"{peak / 2**20:.0f} MiB"] if peak > MOST_BYTES else []
                return replace(
                    found, status=status, seconds=seconds, peak_bytes=peak, faults=(*faults, *slow, *large)
                )
            why = f"no end after {_PATIENCE_S:.0f} s"
        except EOFError:
            why = "the process died"
        return replace(found, seconds=time.monotonic() - started, faults=(why,))

    def end(self) -> None:
        """End the process."""
        self._process.terminate()
        self._process.join()


def _work(pipe: Connection, seeds: Path, home: Path) -> None:
    """Run commands in this process until it is ended."""
    from labcal.cli import main  # noqa: PLC0415 -- the process has begun

    warnings.simplefilter("always")
    jobs = {job.name: job for job in JOBS}
    home.mkdir(parents=True, exist_ok=True)
    os.chdir(home)
    for argv in _warm(seeds):
        _captured(main, argv, home)
    pipe.send("ready")
    while True:
        name, mutant = pipe.recv()
        pipe.send(judged(main, jobs[name], mutant, seeds, home))


Main = Callable[[list[str]], int]


def judged(
    main: Main, job: Job, mutant: Mutant, seeds: Path, home: Path
) -> tuple[int, float, int, list[str]]:
    """Run the command of a mutant here: its status, seconds, greatest memory in bytes, and faults."""
    shutil.rmtree(home / "work", ignore_errors=True)
    work = home / "work"
    work.mkdir(parents=True)
    os.chdir(work)
    argv = _prepared(job, mutant, seeds, work)
    _reset_peak()
    started = time.process_time()  # other processes are not charged to the mutant
    status, result, said = _captured(main, argv, home)
    seconds, peak = time.process_time() - started, _peak_bytes()
    faults = faults_of_ending(status, said, result)
    if status <= PARTIAL and mutant.must_refuse and not _harmless(job, mutant):
        faults.append("accepted")
    if status <= PARTIAL and job.output:
        faults += faults_of_output(work / job.output, result, job.output)
    if status == UNUSABLE and (work / job.output).is_file():
        faults.append("refused, and written all the same")
    return status, seconds, peak, faults


_HARMLESS = re.compile(
    r"(description|caption|reading|phase_deg|direction_deg|random_state|rotation_deg_s|turn_deg|seconds|epochs"
    r"|_m\b|_mm\.|rel\b|max_mm|rmse_mm|p95_mm|mae_mm|further_rmse|mean_signed|effect|ratio|interval|goal|points|seeds)"
)


def _harmless(job: Job, mutant: Mutant) -> bool:
    """Tell whether a figure has no bound: what results say of errors may be of any size."""
    return job.file.endswith("results.json") and _HARMLESS.search(mutant.what) is not None


def _prepared(job: Job, mutant: Mutant, seeds: Path, work: Path) -> list[str]:
    """Return the arguments, with the mutant where they look for it."""
    if job.option:
        text = mutant.data.decode("utf-8", "surrogateescape").replace("\0", "")[:100_000]
        return [word.replace("{text}", text).replace("{seeds}", str(seeds)) for word in job.argv] + ["--json"]
    if job.name == "mark":
        (work / "marked.unfinished").mkdir()
        (work / "marked.unfinished" / ".command").write_bytes(mutant.data)
        return [word.replace("{seeds}", str(seeds)) for word in job.argv] + ["--json"]
    place = work / job.file
    top = job.file.split("/")[0]
    for entry in seeds.iterdir():
        if entry.name != top:
            (work / entry.name).symlink_to(entry)
        elif entry.is_dir():
            shutil.copytree(entry, work / top, symlinks=True)
    place.write_bytes(mutant.data)
    return [word.replace("{file}", str(place)).replace("{seeds}", str(work)) for word in job.argv] + [
        "--json"
    ]


def _warm(seeds: Path) -> list[list[str]]:
    """Return commands that load all that the others use, so that no mutant is charged for it."""
    target = str(seeds / "target.yaml")
    return [
        [
            "reconstruct",
            str(seeds / "mlp.safetensors"),
            str(seeds / "detections.csv"),
            "-o",
            "warm.csv",
            "--force",
        ],
        ["detect", str(seeds / "p.png"), "--target", target, "--workers", "1", "-o", "warm.csv", "--force"],
        ["scene", "check", str(seeds / "scene.yaml")],
    ]


def _captured(main: Main, argv: list[str], home: Path) -> tuple[int, str, str]:
    """Run a command with both streams in files, as a shell would."""
    kept = [os.dup(1), os.dup(2)]
    streams = sys.stdout, sys.stderr
    names = [home / "stdout", home / "stderr"]
    try:
        for descriptor, name in enumerate(names, start=1):
            opened = os.open(name, os.O_WRONLY | os.O_CREAT | os.O_TRUNC)
            os.dup2(opened, descriptor)
            os.close(opened)
        sys.stdout = os.fdopen(os.dup(1), "w", encoding="utf-8", errors="backslashreplace")
        sys.stderr = os.fdopen(os.dup(2), "w", encoding="utf-8", errors="backslashreplace")
        try:
            status = int(main(argv))
        except BaseException as error:  # noqa: BLE001 -- that is what is looked for
            print(f"Traceback: {type(error).__name__}: {error}", file=sys.stderr)
            status = 99
        sys.stdout.close()
        sys.stderr.close()
    finally:
        sys.stdout, sys.stderr = streams
        for descriptor, old in enumerate(kept, start=1):
            os.dup2(old, descriptor)
            os.close(old)
    result, said = (name.read_text(encoding="utf-8", errors="replace") for name in names)
    return status, result, said


def _reset_peak() -> None:
    Path("/proc/self/clear_refs").write_text("5", encoding="ascii")


def _peak_bytes() -> int:
    found = re.search(r"VmHWM:\s+(\d+) kB", Path("/proc/self/status").read_text(encoding="ascii"))
    return 1024 * int(found[1]) if found else 0
