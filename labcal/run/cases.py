"""Independent cases that are all needed: their results, or an error."""

from collections.abc import Callable, Sequence
from concurrent.futures import Executor
from pathlib import Path

from labcal.errors import WorkerError
from labcal.run.case import C, R
from labcal.run.case_files import CaseFiles
from labcal.run.case_work import done
from labcal.run.executor import finished
from labcal.run.failed_cases import raise_failed_cases
from labcal.run.progress import Progress


def run_cases(
    cases: Sequence[C],
    work: Callable[[C], R],
    result_type: type[R],
    folder: Path,
    executor: Executor,
    progress: Progress,
) -> list[R]:
    """Return the results of all cases in their order; those whose file is there already are read.

    The first case that raises ends the run; :func:`~labcal.run.sweep.sweep` keeps its reason and goes on.

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
    progress : Progress

    Raises
    ------
    InputError
        Two cases have one key.
    InputTypeError
        The content of a case has no hash.
    OutputError
        A result cannot be written.
    DeviceError
        A case ends each worker process that tries it; it is named when all others are done and kept.
    """
    given_up: dict[str, WorkerError] = {}
    with CaseFiles(folder, cases, work, result_type) as files:
        kept = {case.key: files.kept(case.key) for case in cases}
        results = {key: None if outcome is None else outcome.result for key, outcome in kept.items()}
        missing = [case for case in cases if results[case.key] is None]
        progress.start("cases", len(cases), done=len(cases) - len(missing))
        for number, future in finished(executor, done, ((work, case) for case in missing)):
            key = missing[number].key
            try:
                end = future.result()
            except WorkerError as error:
                given_up[key] = error
                continue
            if end.text is not None:
                results[key] = files.keep(key, end.text, end.seconds).result
            progress.advance()
    raise_failed_cases(given_up, len(cases), "cases", "Free memory, or use fewer workers.")
    return [result for case in cases if (result := results[case.key]) is not None]
