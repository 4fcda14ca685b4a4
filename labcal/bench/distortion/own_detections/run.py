"""All parts of detections of one's own: measured on an executor, with a result file each."""

from collections.abc import Sequence
from concurrent.futures import Executor
from pathlib import Path

from labcal.bench.distortion.figures import CaseFigures, MethodFigures
from labcal.bench.distortion.method_sweep import MethodWork, sweep_methods
from labcal.bench.distortion.own_detections.case import OwnCase, held_out_parts
from labcal.bench.distortion.own_detections.given import OwnDetections
from labcal.bench.distortion.own_detections.measuring import measured_views
from labcal.bench.distortion.own_detections.result import OwnResult, Part, own_results
from labcal.bench.distortion.plan import Plan
from labcal.run.progress import Progress


def measured_detections(
    given: Sequence[OwnDetections],
    plan: Plan,
    seed: int,
    folder: Path,
    executor: Executor,
    progress: Progress,
) -> list[OwnResult]:
    """Measure all methods of a plan on detections of one's own.

    Parameters
    ----------
    given : sequence of OwnDetections
    plan : Plan
    seed : int
    folder : Path
        Where the files of results are.
    executor : Executor
    progress : Progress

    Raises
    ------
    InputError
        No picture could be read, or there are too few views.
    OutputError, DeviceError
        As of :func:`~labcal.bench.distortion.method_sweep.sweep_methods`.
    """
    cases: list[OwnCase] = []
    for one in given:
        found = one.measured(executor, progress)
        dots = found.detections
        if dots is None:
            continue
        cases += [
            OwnCase(
                found.name, fold, found.shoot, dots, held_out, plan.methods, seed, plan.settings, plan.sources
            )
            for fold, held_out in enumerate(held_out_parts(found.shoot, set(dots.views)))
        ]
    if not cases:
        return []
    work = MethodWork(measured_views, CaseFigures, MethodFigures)
    outcomes = sweep_methods(cases, work, folder / "detection-cases", executor, progress)
    return own_results(
        [
            Part(case, CaseFigures(reason=one.reason) if one.result is None else one.result)
            for case, one in zip(cases, outcomes, strict=True)
        ]
    )
