"""``labcal bench detect``: all checks of the detector."""

from collections.abc import Callable
from pathlib import Path

from labcal.errors import UnknownNameError
from labcal.experiments.bench_detect.accuracy import accuracy_findings
from labcal.experiments.bench_detect.bias import bias_checks
from labcal.experiments.bench_detect.findings import Bench, Findings
from labcal.experiments.bench_detect.hostile import hostile_findings
from labcal.experiments.bench_detect.real import real_findings
from labcal.experiments.bench_detect.speed import speed_findings
from labcal.experiments.bench_detect.suite import suite_findings
from labcal.experiments.bench_settings import BenchSettings
from labcal.report.bench import BenchResult
from labcal.run.json_text import to_json
from labcal.run.outputs import unfinished_folder, write_file
from labcal.run.progress import Progress

GROUPS: dict[str, Callable[[Bench], Findings]] = {
    "suite": suite_findings,
    "accuracy": accuracy_findings,
    "real": real_findings,
    "bias": lambda bench: Findings(bias_checks(bench.seed), []),
    "speed": speed_findings,
    "hostile": hostile_findings,
}
"""Groups of checks, in the order in which they are measured."""


def bench_detect(folder: Path, settings: BenchSettings, progress: Progress) -> BenchResult:
    """Measure every check and write ``results.json``.

    Parameters
    ----------
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
    DeviceError
        There is no LLVM library for the renderer.
    """
    for name in settings.groups:
        if name not in GROUPS:
            raise UnknownNameError("group of checks", name, GROUPS)
    wanted = [name for name in GROUPS if not settings.groups or name in settings.groups]
    command = f"bench detect {settings.quick} {settings.seed} {wanted}"
    with unfinished_folder(folder, command, force=settings.force) as working:
        bench = Bench(settings.quick, settings.seed, working, progress)
        found = [GROUPS[name](bench) for name in wanted]
        result = BenchResult(
            bench="detect",
            quick=settings.quick,
            checks=tuple(check for one in found for check in one.checks),
            beside=tuple(figure for one in found for figure in one.beside),
            notes=tuple(note for one in found for note in one.notes),
        )
        write_file(working / "results.json", to_json(result) + "\n", force=True)
    return result
