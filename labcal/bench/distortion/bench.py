"""``labcal bench distortion``: every method on every cell of a plan."""

from collections.abc import Sequence
from concurrent.futures import Executor
from pathlib import Path

from labcal.bench.distortion.case import Case
from labcal.bench.distortion.cost import require_consent
from labcal.bench.distortion.figures import CaseFigures, MethodFigures
from labcal.bench.distortion.lines import HEADER, lines_of, results_table
from labcal.bench.distortion.measurements import Measurements
from labcal.bench.distortion.measuring import measured_case
from labcal.bench.distortion.method_seconds import timings_table
from labcal.bench.distortion.method_sweep import MethodWork, sweep_methods
from labcal.bench.distortion.own_detections.given import own_detections
from labcal.bench.distortion.own_detections.result import own_lines
from labcal.bench.distortion.own_detections.run import measured_detections
from labcal.bench.distortion.page.command import command_line
from labcal.bench.distortion.page.findings import Findings
from labcal.bench.distortion.page.page import PAGE, distortion_page
from labcal.bench.distortion.protocols.run import measured_protocols
from labcal.bench.distortion.requested_plan import plan_of
from labcal.bench.distortion.result import DistortionResult
from labcal.bench.method_executor import open_method_executor
from labcal.bench.settings import BenchSettings
from labcal.run.json_text import to_json
from labcal.run.machine import usable_cores
from labcal.run.made import make_folder
from labcal.run.outputs import write_file
from labcal.run.progress import Progress
from labcal.run.unfinished import unfinished_folder


def bench_distortion(folder: Path, settings: BenchSettings, progress: Progress) -> DistortionResult:
    """Measure every case of a plan, and write ``results.csv``, ``results.json``, figures and ``index.html``.

    Parameters
    ----------
    folder : Path
        It appears when all is measured.
    settings : BenchSettings
    progress : Progress

    Raises
    ------
    UnknownNameError
        There is no such plan, factor, family or method.
    InputError
        A level is not allowed, a setting of a method is not known, there are too many cases, or they take
        hours and `yes` is not set.
    OutputError
        The folder exists already.
    DeviceError
        The scheduler does not answer, or there is no LLVM library for the renderer.
    """
    plan = plan_of(settings)
    require_consent(plan, settings)
    given = own_detections(settings.detections)
    command = f"bench distortion {settings.seed} {plan.model_dump_json()}"
    command += "".join(f" {one.name}" for one in given)
    with (
        open_method_executor(
            min(usable_cores(), plan.case_count), settings.scheduler, plan.methods
        ) as executor,
        unfinished_folder(folder, command, force=settings.force) as working,
    ):
        own = measured_detections(given, plan, settings.seed, working, executor, progress)
        cases = plan.cases(settings.seed)
        lines = lines_of(cases, _measured(cases, working, executor, progress))
        table = results_table(lines, own_lines(own, HEADER, settings.seed))
        write_file(working / "results.csv", table, force=True)
        protocols = measured_protocols(plan, settings.seed, working, executor, progress)
        measured = Measurements(plan, settings.seed, len(cases), lines, tuple(own), protocols)
        make_folder(working / "figures")
        for name, text in measured.figures().items():
            write_file(working / "figures" / name, text, force=True)
        result = measured.result(quick=settings.quick, command=command_line(settings))
        write_file(working / "results.json", to_json(result) + "\n", force=True)
        page = distortion_page(Findings(result, measured.summaries, table))
        write_file(working / PAGE, page.text(), force=True)
    return result


def _measured(
    cases: Sequence[Case], folder: Path, executor: Executor, progress: Progress
) -> list[CaseFigures]:
    """Return the figures of all cases, in their order, and write ``timings.csv``."""
    work = MethodWork(measured_case, CaseFigures, MethodFigures)
    found = sweep_methods(cases, work, folder / "cases", executor, progress)
    figures = [CaseFigures(reason=one.reason) if one.result is None else one.result for one in found]
    seconds = [one.seconds for one in found]
    write_file(folder / "timings.csv", timings_table(cases, figures, seconds), force=True)
    return figures
