"""``labcal bench distortion``: every method on every cell of a plan."""

from collections.abc import Sequence
from concurrent.futures import Executor
from pathlib import Path

from labcal.bench.distortion.case import NO_FAULT, Case, Measured, Source
from labcal.bench.distortion.cell_summary import summarised
from labcal.bench.distortion.checks import distortion_checks, failure_notes
from labcal.bench.distortion.cost import announcement
from labcal.bench.distortion.curves import figures_of
from labcal.bench.distortion.figures import CaseFigures
from labcal.bench.distortion.lines import HEADER, lines_of, results_table
from labcal.bench.distortion.measuring import measured_case, prepared
from labcal.bench.distortion.method_seconds import timings_table
from labcal.bench.distortion.network_answer import network_answer
from labcal.bench.distortion.own_detections.given import own_detections
from labcal.bench.distortion.own_detections.result import own_lines
from labcal.bench.distortion.own_detections.run import measured_detections
from labcal.bench.distortion.page.command import command_line
from labcal.bench.distortion.page.findings import Findings
from labcal.bench.distortion.page.page import distortion_page
from labcal.bench.distortion.plan import FULL, QUICK, Plan, load_plan
from labcal.bench.distortion.protocols.run import measured_protocols
from labcal.bench.distortion.rendered_curves import rendered_figures, rendered_notes
from labcal.bench.distortion.rendered_plan import RenderedPlan, is_rendered_change
from labcal.bench.distortion.result import DistortionResult, family_figures
from labcal.bench.distortion.sensitivity import sensitivities
from labcal.bench.distortion.sensitivity_figures import sensitivity_figures
from labcal.bench.distortion.winners import winners
from labcal.bench.settings import BenchSettings
from labcal.errors import InputError
from labcal.render.llvm import ensure_llvm
from labcal.report.page.output import PageOutput
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
    """Measure every case of a plan, and write ``results.csv``, ``results.json``, figures and ``page.html``.

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
        The scheduler does not answer, or there is no LLVM library for the renderer.
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
        table = results_table(lines, own_lines(own, HEADER, settings.seed))
        write_file(working / "results.csv", table, force=True)
        summaries = summarised(lines)
        usual = [one for one in summaries if one.cell.is_usual]
        rendered = [
            one for one in summaries if one.cell.source is Source.RENDERED and one.cell.fault == NO_FAULT
        ]
        make_folder(working / "figures")
        sensitivity = sensitivities(lines)
        drawn = figures_of(usual) | rendered_figures(rendered) | sensitivity_figures(sensitivity)
        for name, text in drawn.items():
            write_file(working / "figures" / name, text, force=True)
        result = DistortionResult(
            bench="distortion",
            quick=settings.quick,
            checks=tuple(distortion_checks(summaries)),
            notes=(*failure_notes(summaries), *rendered_notes(rendered)),
            plan=plan,
            plan_sha256=plan.sha256,
            first_seed=settings.seed,
            cases=len(cases),
            answer=tuple(network_answer(usual)),
            families=tuple(family_figures(usual)),
            winners=tuple(winners(usual)),
            outside=tuple(family_figures(usual, Measured.OUTSIDE)),
            sensitivity=tuple(sensitivity),
            rendered=tuple(family_figures(rendered)),
            detections=tuple(own),
            protocols=measured_protocols(plan, settings.seed, working, executor, progress),
        )
        write_file(working / "results.json", to_json(result) + "\n", force=True)
        page = distortion_page(Findings(result, summaries, command_line(settings), table))
        PageOutput(working / "page.html", force=True).write(page)
    return result


def plan_of(settings: BenchSettings) -> Plan:
    """Return the plan of settings, checked as far as that is possible before it starts.

    Raises
    ------
    UnknownNameError, InputError, DeviceError
        As of :func:`bench_distortion`.
    """
    name = settings.plan or (QUICK if settings.quick else FULL)
    plan = load_plan(name, settings.overrides, settings.methods, settings.seeds)
    plan = plan.model_copy(update={"rendered": _rendered_plan(plan, settings)})
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


def _rendered_plan(plan: Plan, settings: BenchSettings) -> RenderedPlan | None:
    """Return the section of cases through pictures where they are asked for.

    Raises
    ------
    InputError
        They are changed and not asked for.
    DeviceError
        There is no LLVM library for the renderer.
    """
    if settings.rendered:
        if settings.scheduler is None:
            ensure_llvm()
        return plan.rendered or RenderedPlan()
    changed = [change for change in settings.overrides if is_rendered_change(change)]
    if changed:
        raise InputError(
            f"`overrides` sets '{changed[0]}', which concerns pictures, but none are asked for: give "
            "`rendered=True`, too, or leave it out."
        )
    return None


def _measured(
    cases: Sequence[Case], folder: Path, executor: Executor, progress: Progress
) -> list[CaseFigures]:
    """Return the figures of all cases, in their order, and write ``timings.csv``."""
    found = sweep(cases, measured_case, CaseFigures, folder / "cases", executor, progress)
    figures = [CaseFigures(reason=one.reason) if one.result is None else one.result for one in found]
    seconds = [one.seconds for one in found]
    write_file(folder / "timings.csv", timings_table(cases, figures, seconds), force=True)
    return figures
