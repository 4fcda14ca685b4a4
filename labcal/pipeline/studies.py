"""Studies of labcal itself: the experiments of the paper, and benchmarks."""

from typing import TYPE_CHECKING

from labcal.arguments import one_text, settings_of
from labcal.paths import AnyPath, as_path
from labcal.run.progress import Progress, progress_of

if TYPE_CHECKING:
    from labcal.bench.settings import BenchSettings
    from labcal.paper.reproduce import ReproduceSettings
    from labcal.report.bench import BenchResult
    from labcal.report.reproduction import Reproduction


def reproduce(
    folder: AnyPath, settings: "ReproduceSettings | None" = None, progress: Progress | None = None
) -> "Reproduction":
    """Reproduce the paper, its rows, claims and studies or some of them, and write the results and a page.

    Parameters
    ----------
    folder : path
        The folder to appear. What an interrupted run left is gone on with.
    settings : ReproduceSettings, optional
    progress : Progress, optional

    Returns
    -------
    Reproduction
        Rows and claims with their verdicts, studies; errors in mm, and in m where the paper prints them.

    Raises
    ------
    OutputError, DeviceError
        As of :func:`labcal.paper.reproduce.reproduce`.

    Examples
    --------
    >>> from labcal import pipeline
    >>> found = pipeline.reproduce("out", pipeline.ReproduceSettings(quick=True))  # doctest: +SKIP
    >>> len(found.rows)  # doctest: +SKIP
    22
    """
    from labcal.paper.reproduce import ReproduceSettings, reproduce
    from labcal.run.claims import FolderOutput, claim_outputs

    place, settings = as_path(folder), settings_of(settings, ReproduceSettings)
    receiver = progress_of(progress)
    claim_outputs([FolderOutput(place)], (), force=settings.force)
    return reproduce(place, settings, receiver)


def bench(
    what: str,
    folder: AnyPath,
    settings: "BenchSettings | None" = None,
    progress: Progress | None = None,
) -> "BenchResult":
    """Measure how good labcal is, every figure against its limit, and write the results.

    Parameters
    ----------
    what : {"render", "detect", "solve", "distortion"}
    folder : path
        The folder to appear, with ``results.json``. ``distortion`` also writes ``index.html``, one page of
        all that it found, and ``results.csv``, a line for each case, method and region.
    settings : BenchSettings, optional
    progress : Progress, optional

    Returns
    -------
    BenchResult
        Every figure as a check, with its limit.

    Raises
    ------
    UnknownNameError, InputError
        There is no such benchmark, or a setting does not apply to it.
    OutputError
        The folder may not be made.

    Examples
    --------
    >>> from labcal import pipeline
    >>> found = pipeline.bench("detect", "out", pipeline.BenchSettings(quick=True))  # doctest: +SKIP
    >>> [check.name for check in found.checks if not check.ok]  # doctest: +SKIP
    []
    """
    from labcal.bench.benchmarks import run_benchmark
    from labcal.bench.settings import BenchSettings

    how, receiver = settings_of(settings, BenchSettings), progress_of(progress)
    return run_benchmark(one_text(what, "what"), as_path(folder), how, receiver)
