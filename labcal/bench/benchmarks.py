"""The benchmarks by name."""

from labcal.bench.detect.bench import bench_detect
from labcal.bench.detect.real import real_home
from labcal.bench.render.bench import bench_render
from labcal.bench.settings import BenchSettings
from labcal.bench.solve.bench import bench_solve
from labcal.errors import InputError, UnknownNameError
from labcal.paths import AnyPath, as_path
from labcal.report.bench import BenchResult
from labcal.run.claims import FolderOutput, claim_outputs
from labcal.run.progress import Progress

BENCHMARKS = {"render": bench_render, "detect": bench_detect, "solve": bench_solve}


def run_benchmark(what: str, folder: AnyPath, settings: BenchSettings, progress: Progress) -> BenchResult:
    """Run a benchmark into a new folder.

    Parameters
    ----------
    what : {"render", "detect", "solve"}
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
    if what not in BENCHMARKS:
        raise UnknownNameError("benchmark", what, BENCHMARKS)
    if settings.groups and what == "render":
        raise InputError("`groups` names groups of checks, of which the benchmark 'render' has none.")
    if settings.methods and what != "solve":
        raise InputError("`methods` goes with 'bench solve', which measures methods. Leave it out.")
    if settings.scheduler is not None and what != "solve":
        raise InputError(
            f"`scheduler` goes with 'bench solve', whose cases a cluster can do; '{what}' is measured here. "
            "Leave it out."
        )
    photographs = real_home()
    claim_outputs([FolderOutput(folder)], () if photographs is None else (photographs,), force=settings.force)
    return BENCHMARKS[what](folder, settings, progress)
