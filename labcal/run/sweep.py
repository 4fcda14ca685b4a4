"""Sweeps: independent cases of which some may fail; each has an outcome, and a file of its own."""

from collections.abc import Callable, Sequence
from concurrent.futures import Executor, Future
from pathlib import Path

from labcal.errors import LabcalError, WorkerError
from labcal.run.case import C, CaseOutcome, Fault, R
from labcal.run.case_files import CaseFiles
from labcal.run.case_work import Done, done_or_reason, unexpected
from labcal.run.executor import finished
from labcal.run.progress import Progress


def sweep(
    cases: Sequence[C],
    work: Callable[[C], R],
    result_type: type[R],
    folder: Path,
    executor: Executor,
    progress: Progress,
) -> list[CaseOutcome[R]]:
    """Return the outcomes of all cases in their order; those whose file is there already are read.

    A case that raises has a reason in place of a result, and the others go on. Reasons are kept like results:
    a run that resumes does not try such a case again, unless the machine was at fault (`Fault.MACHINE`).

    Parameters
    ----------
    cases : sequence of Case
        Their keys differ.
    work : callable
        A function of the module level, so that other processes find it. Its result must depend on the case
        alone; it is called with every library set to one thread.
    result_type : type
        The pydantic model that `work` returns.
    folder : Path
        Where the files ``<key>.json`` are; made where it is missing. A file whose case, function or code has
        another hash is made anew.
    executor : Executor
        Of :func:`~labcal.run.executor.open_executor`, for example.
    progress : Progress

    Returns
    -------
    list of CaseOutcome
        The results are the same for every executor; the seconds are not.

    Raises
    ------
    InputError
        Two cases have one key.
    InputTypeError
        The content of a case has no hash.
    OutputError
        A file cannot be written.
    DeviceError
        The executor has failed as a whole: there are no processes to be had, or no cluster.
    """
    with CaseFiles(folder, cases, work, result_type) as files:
        outcomes = {case.key: files.kept(case.key) for case in cases}
        missing = [case for case in cases if outcomes[case.key] is None]
        progress.start("cases", len(cases), done=len(cases) - len(missing))
        for number, future in finished(executor, done_or_reason, ((work, case) for case in missing)):
            key = missing[number].key
            outcomes[key] = _kept(files, key, future)
            progress.advance()
    return [outcome for case in cases if (outcome := outcomes[case.key]) is not None]


def _kept(files: CaseFiles[C, R], key: str, future: Future[Done]) -> CaseOutcome[R]:
    """Return the outcome of a case that is finished, and keep it."""
    try:
        end = future.result()
        if end.text is not None:
            return files.keep(key, end.text, end.seconds)
    except (WorkerError, MemoryError) as error:
        end = Done(None, str(error), 0.0, Fault.MACHINE)
    except LabcalError:  # of the executor or of the disk: those of a case come as its reason
        raise
    except Exception as error:  # noqa: BLE001 -- it cannot be sent, or its result is not of its type
        end = Done(None, unexpected(error), 0.0, Fault.PROGRAM)
    return files.keep_reason(CaseOutcome(key, None, end.reason, end.seconds, end.fault))
