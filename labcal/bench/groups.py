"""A benchmark whose checks come in groups that can be measured one by one."""

from collections.abc import Callable, Iterator, Mapping
from concurrent.futures import Executor
from contextlib import contextmanager
from dataclasses import dataclass
from pathlib import Path

from labcal.bench.method_executor import open_method_executor
from labcal.bench.settings import BenchSettings
from labcal.errors import UnknownNameError
from labcal.report.bench import BenchResult, Check, Figure
from labcal.run.executor import open_executor
from labcal.run.json_text import to_json
from labcal.run.machine import usable_cores
from labcal.run.outputs import write_file
from labcal.run.progress import Progress
from labcal.run.unfinished import unfinished_folder


@dataclass(frozen=True)
class Bench:
    """The settings of every group of checks."""

    quick: bool
    seed: int
    folder: Path
    """Folder for files of a group besides its figures."""
    progress: Progress
    methods: tuple[str, ...] = ()
    """Methods to measure in addition to the default ones."""
    cluster: Executor | None = None
    """The executor for the cases of a group that has many, in place of processes of this machine."""

    @contextmanager
    def executor(self, cases: int) -> Iterator[Executor]:
        """Yield the executor for so many cases."""
        if self.cluster is not None:
            yield self.cluster
            return
        with open_method_executor(min(usable_cores(), cases), None, self.methods) as executor:
            yield executor


@dataclass(frozen=True)
class Findings:
    """The figures of one group."""

    checks: list[Check]
    references: list[Figure]
    """Figures for comparison, without a limit."""
    notes: tuple[str, ...] = ()
    """Notes on checks that were left out, with the reason."""


Groups = Mapping[str, Callable[[Bench], Findings]]
"""Groups of checks by name, in the order in which they are measured."""


def measured_groups(
    name: str, groups: Groups, folder: Path, settings: BenchSettings, progress: Progress
) -> BenchResult:
    """Measure the selected groups, and write ``results.json``.

    Parameters
    ----------
    name : str
        The benchmark's.
    groups : mapping
        All that it has.
    folder : Path
        It appears when all is measured.
    settings : BenchSettings
    progress : Progress

    Raises
    ------
    UnknownNameError
        There is no such group of checks.
    OutputError
        The folder exists already.
    InputError, DeviceError
        The scheduler's address is none, or it does not answer.
    """
    for wanted in settings.groups:
        if wanted not in groups:
            raise UnknownNameError("group of checks", wanted, groups)
    chosen = [group for group in groups if not settings.groups or group in settings.groups]
    command = f"bench {name} {settings.quick} {settings.seed} {chosen}"
    if settings.methods:
        command += f" {list(settings.methods)}"
    with (
        _cluster(settings.scheduler) as cluster,
        unfinished_folder(folder, command, force=settings.force) as working,
    ):
        methods = tuple(settings.methods)
        bench = Bench(settings.quick, settings.seed, working, progress, methods, cluster)
        found = [groups[group](bench) for group in chosen]
        result = BenchResult(
            bench=name,
            quick=settings.quick,
            checks=tuple(check for one in found for check in one.checks),
            beside=tuple(figure for one in found for figure in one.references),
            notes=tuple(note for one in found for note in one.notes),
        )
        write_file(working / "results.json", to_json(result) + "\n", force=True)
    return result


@contextmanager
def _cluster(scheduler: str | None) -> Iterator[Executor | None]:
    """Yield the executor of a cluster, if there is one; one that does not answer ends the work here."""
    if scheduler is None:
        yield None
        return
    with open_executor(usable_cores(), scheduler) as executor:
        yield executor
