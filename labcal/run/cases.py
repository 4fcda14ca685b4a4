"""Independent cases with one result file each, so that an interrupted run resumes where it stopped."""

from collections import Counter
from collections.abc import Callable, Sequence
from concurrent.futures import Executor
from pathlib import Path
from typing import Protocol, TypeVar, runtime_checkable

from pydantic import BaseModel, ValidationError

from labcal.errors import InputError, WorkerError
from labcal.run.executor import finished
from labcal.run.failed_cases import raise_failed_cases
from labcal.run.made import make_folder
from labcal.run.outputs import write_file
from labcal.run.progress import Progress


@runtime_checkable  # so that tests can check annotations
class Case(Protocol):
    """A named unit of work."""

    @property
    def key(self) -> str:
        """The name of its result file, without the ending."""


C = TypeVar("C", bound=Case)
R = TypeVar("R", bound=BaseModel)


def run_cases(
    cases: Sequence[C],
    work: Callable[[C], R],
    result_type: type[R],
    folder: Path,
    executor: Executor,
    progress: Progress,
) -> list[R]:
    """Return the results of all cases in their order; those whose file is there already are read.

    Parameters
    ----------
    cases : sequence of Case
        Their keys differ.
    work : callable
        A function of the module level, so that other processes find it.
    result_type : type
        The pydantic model that `work` returns.
    folder : Path
        Where the files ``<key>.json`` are; made where it is missing.
    executor : Executor
    progress : Progress

    Raises
    ------
    InputError
        Two cases have one key.
    OutputError
        A result cannot be written.
    DeviceError
        A case ends each worker process that tries it; it is named when all others are done and kept.
    """
    make_folder(folder)
    files = {case.key: folder / f"{case.key}.json" for case in cases}
    if len(files) < len(cases):
        twice = next(key for key, count in Counter(case.key for case in cases).items() if count > 1)
        raise InputError(f"Two cases are named '{twice}', and each result needs a file of its own.")
    results = {case.key: _kept_result(files[case.key], result_type) for case in cases}
    missing = [case for case in cases if results[case.key] is None]
    progress.start("cases", len(cases))
    progress.advance(len(cases) - len(missing))
    given_up: dict[str, WorkerError] = {}
    for number, future in finished(executor, work, [(case,) for case in missing]):
        key = missing[number].key
        try:
            text = future.result().model_dump_json(indent=2) + "\n"
        except WorkerError as error:
            given_up[key] = error
            continue
        write_file(files[key], text, force=True)
        results[key] = result_type.model_validate_json(text)  # as it will be read
        progress.advance()
    raise_failed_cases(given_up, len(cases), "cases", "Free memory, or use fewer workers.")
    return [result for case in cases if (result := results[case.key]) is not None]


def _kept_result(file: Path, result_type: type[R]) -> R | None:
    """Return the result of an earlier run; None if there is none, or an incomplete one.

    A file that a power cut has cut short, or that another version wrote, is made anew.
    """
    try:
        return result_type.model_validate_json(file.read_bytes())
    except (FileNotFoundError, ValidationError):
        return None
