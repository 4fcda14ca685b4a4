"""A benchmark whose checks come in groups that can be measured one by one."""

from collections.abc import Callable, Mapping
from dataclasses import dataclass
from pathlib import Path

from labcal.bench.settings import BenchSettings
from labcal.errors import UnknownNameError
from labcal.report.bench import BenchResult, Check, Figure
from labcal.run.json_text import to_json
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
    """
    for wanted in settings.groups:
        if wanted not in groups:
            raise UnknownNameError("group of checks", wanted, groups)
    chosen = [group for group in groups if not settings.groups or group in settings.groups]
    command = f"bench {name} {settings.quick} {settings.seed} {chosen}"
    if settings.methods:
        command += f" {list(settings.methods)}"
    with unfinished_folder(folder, command, force=settings.force) as working:
        bench = Bench(settings.quick, settings.seed, working, progress, tuple(settings.methods))
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
