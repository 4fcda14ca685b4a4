"""All cases of a plan's protocols: measured on an executor, with a result file each."""

from concurrent.futures import Executor
from pathlib import Path

from labcal.bench.distortion.method_sweep import MethodWork, sweep_methods
from labcal.bench.distortion.plan import Plan
from labcal.bench.distortion.protocols.case import ProtocolCase
from labcal.bench.distortion.protocols.figures import ProtocolCaseFigures, ProtocolMethodFigures
from labcal.bench.distortion.protocols.measuring import measured_protocol
from labcal.bench.distortion.protocols.result import ProtocolResult, protocol_results
from labcal.bench.distortion.protocols.tables import protocols_table
from labcal.run.outputs import write_file
from labcal.run.progress import Progress


def protocol_cases(plan: Plan, first_seed: int) -> list[ProtocolCase]:
    """Return a case for each protocol and seed."""
    return [
        ProtocolCase(name, first_seed + number, plan.methods, plan.settings, plan.sources)
        for name in plan.protocols
        for number in range(plan.seeds)
    ]


def measured_protocols(
    plan: Plan, first_seed: int, folder: Path, executor: Executor, progress: Progress
) -> tuple[ProtocolResult, ...]:
    """Measure the protocols of a plan, and write ``protocols.csv`` where there are any.

    Parameters
    ----------
    plan : Plan
    first_seed : int
    folder : Path
        Where the files of results are.
    executor : Executor
    progress : Progress

    Raises
    ------
    OutputError, DeviceError
        As of :func:`~labcal.bench.distortion.method_sweep.sweep_methods`.
    """
    cases = protocol_cases(plan, first_seed)
    if not cases:
        return ()
    work = MethodWork(measured_protocol, ProtocolCaseFigures, ProtocolMethodFigures)
    outcomes = sweep_methods(cases, work, folder / "protocol-cases", executor, progress)
    found = [
        (case, one.reason or "no result" if one.result is None else one.result)
        for case, one in zip(cases, outcomes, strict=True)
    ]
    write_file(folder / "protocols.csv", protocols_table(found), force=True)
    return tuple(protocol_results(found))
