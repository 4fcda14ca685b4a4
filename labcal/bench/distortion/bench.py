"""``labcal bench distortion``: every method on every cell of a plan."""

from collections.abc import Sequence
from concurrent.futures import Executor
from pathlib import Path

from labcal.bench.distortion.case import Case
from labcal.bench.distortion.cell_summary import summarised
from labcal.bench.distortion.checks import distortion_checks, failure_notes
from labcal.bench.distortion.cost import announcement
from labcal.bench.distortion.curves import figures_of
from labcal.bench.distortion.figures import CaseFigures
from labcal.bench.distortion.lines import HEADER, lines_of, results_table, timings_table
from labcal.bench.distortion.measuring import measured_case, prepared
from labcal.bench.distortion.network_answer import network_answer
from labcal.bench.distortion.own_detections.given import own_detections
from labcal.bench.distortion.own_detections.result import own_lines
from labcal.bench.distortion.own_detections.run import measured_detections
from labcal.bench.distortion.plan import FULL, QUICK, Plan, load_plan
from labcal.bench.distortion.protocols.run import measured_protocols
from labcal.bench.distortion.result import DistortionResult, family_figures
from labcal.bench.distortion.winners import winners
from labcal.bench.settings import BenchSettings
from labcal.errors import InputError
from labcal.run.executor import open_executor
from labcal.run.json_text import to_json
from labcal.run.machine import usable_cores
from labcal.run.made import make_folder
from labcal.run.outputs import write_file
from labcal.run.progress import Progress
from labcal.run.sweep import sweep
from labcal.run.unfinished import unfinished_folder

MOST_CASES = 200_000
"""Of one run. More would take months, and their results do not fit into memory."""


def bench_distortion(folder: Path, settings: BenchSettings, progress: Progress) -> DistortionResult:
    """Measure every case of a plan, and write ``results.csv``, ``results.json``, ``timings.csv`` and figures.

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
        A level is not allowed, a setting of a method is not known, or there are too many cases.
    OutputError
        The folder exists already.
    DeviceError
        The scheduler does not answer.
    """
    plan = plan_of(settings)
    given = own_detections(settings.detections)
    command = f"bench distortion {settings.seed} {plan.model_dump_json()}"
    command += "".join(f" {one.name}" for one in given)
    with (
        open_executor(min(usable_cores(), plan.case_count), settings.scheduler) as executor,
        unfinished_folder(folder, command, force=settings.force) as working,
    ):
        own = measured_detections(given, plan, settings.seed, working, executor, progress)
        cases = plan.cases(settings.seed)
        lines = lines_of(cases, _measured(cases, working, executor, progress))
        further = own_lines(own, HEADER, settings.seed)
        write_file(working / "results.csv", results_table(lines, further), force=True)
        summaries = summarised(lines)
        usual = [one for one in summaries if one.cell.is_usual]
        make_folder(working / "figures")
        for name, text in figures_of(usual).items():
            write_file(working / "figures" / name, text, force=True)
        result = DistortionResult(
            bench="distortion",
            quick=settings.quick,
            checks=tuple(distortion_checks(summaries)),
            notes=tuple(failure_notes(summaries)),
            plan=plan,
            plan_sha256=plan.sha256,
            first_seed=settings.seed,
            cases=len(cases),
            answer=tuple(network_answer(usual)),
            families=tuple(family_figures(usual)),
            winners=tuple(winners(usual)),
            detections=tuple(own),
            protocols=measured_protocols(plan, settings.seed, working, executor, progress),
        )
        write_file(working / "results.json", to_json(result) + "\n", force=True)
    return result


def plan_of(settings: BenchSettings) -> Plan:
    """Return the plan of settings, checked as far as that is possible before it starts.

    Raises
    ------
    UnknownNameError, InputError
        As of :func:`bench_distortion`.
    """
    name = settings.plan or (QUICK if settings.quick else FULL)
    plan = load_plan(name, settings.overrides, settings.methods, settings.seeds)
    if plan.case_count > MOST_CASES:
        raise InputError(
            f"The plan '{name}' has {announcement(plan)}. At most {MOST_CASES:,} cases are measured at a "
            "time: leave levels or seeds out, or share it out among several plans."
        )
    for method in plan.settings:
        if method not in plan.methods:
            raise InputError(f"The plan '{name}' has settings of '{method}', which it does not measure.")
    first = next(iter(plan.cells()))
    case = Case(first, settings.seed, plan.methods, plan.measured, plan.tests, plan.settings)
    for method in plan.methods:
        prepared(case, method)  # tells now, not after an hour, whether there is such a method
    return plan


def _measured(
    cases: Sequence[Case], folder: Path, executor: Executor, progress: Progress
) -> list[CaseFigures]:
    """Return the figures of all cases, in their order, and write ``timings.csv``."""
    found = sweep(cases, measured_case, CaseFigures, folder / "cases", executor, progress)
    seconds = [one.seconds for one in found]
    write_file(folder / "timings.csv", timings_table(cases, seconds), force=True)
    return [CaseFigures(reason=one.reason) if one.result is None else one.result for one in found]
