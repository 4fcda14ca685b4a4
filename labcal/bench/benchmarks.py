"""The benchmarks by name."""

from collections.abc import Callable
from pathlib import Path

from labcal.arguments import one_named
from labcal.bench.detect.bench import bench_detect
from labcal.bench.detect.real import real_home
from labcal.bench.distortion.bench import bench_distortion
from labcal.bench.render.bench import bench_render
from labcal.bench.settings import BenchSettings
from labcal.bench.solve.bench import bench_solve
from labcal.errors import InputError
from labcal.paths import AnyPath, as_path
from labcal.report.bench import BenchResult
from labcal.run.claims import FolderOutput, claim_outputs
from labcal.run.progress import Progress

Benchmark = Callable[[Path, BenchSettings, Progress], BenchResult]
BENCHMARKS: dict[str, Benchmark] = {
    "render": bench_render,
    "detect": bench_detect,
    "solve": bench_solve,
    "distortion": bench_distortion,
}
_WITHOUT_GROUPS = ("render", "distortion")
_OF_METHODS = ("solve", "distortion")


def run_benchmark(what: str, folder: AnyPath, settings: BenchSettings, progress: Progress) -> BenchResult:
    """Run a benchmark into a new folder.

    Parameters
    ----------
    what : {"render", "detect", "solve", "distortion"}
    folder : str or os.PathLike
    settings : BenchSettings
    progress : Progress

    Raises
    ------
    UnknownNameError
        There is no such benchmark.
    InputError
        A setting would be dropped.
    OutputError
        The folder may not be made.
    """
    folder = as_path(folder)
    benchmark = one_named(BENCHMARKS, "benchmark", what)
    if settings.groups and what in _WITHOUT_GROUPS:
        raise InputError(f"`groups` names groups of checks, of which the benchmark '{what}' has none.")
    if settings.methods and what not in _OF_METHODS:
        raise InputError(
            "`methods` goes with 'bench solve' and 'bench distortion', which measure methods. Leave it out."
        )
    if settings.scheduler is not None and what not in _OF_METHODS:
        raise InputError(
            "`scheduler` goes with 'bench solve' and 'bench distortion', whose cases a cluster can do; "
            f"'{what}' is measured here. Leave it out."
        )
    if what != "distortion":
        _refuse_plan(settings)
    photographs = real_home()
    read = [*map(as_path, settings.detections), *([] if photographs is None else [photographs])]
    claim_outputs([FolderOutput(folder)], read, force=settings.force)
    return benchmark(folder, settings, progress)


def _refuse_plan(settings: BenchSettings) -> None:
    """Raise where settings of a plan are given to a benchmark that has none."""
    given = {
        "plan": settings.plan,
        "overrides": settings.overrides or None,
        "seeds": settings.seeds,
        "rendered": settings.rendered or None,
        "detections": settings.detections or None,
        "yes": settings.yes or None,
    }
    for name, value in given.items():
        if value is not None:
            raise InputError(f"`{name}` goes with 'bench distortion', which measures a plan. Leave it out.")
