"""Many independent cases, one result file each, so that an interrupted run goes on where it stopped."""

from collections.abc import Callable, Iterable, Sequence
from concurrent.futures import FIRST_COMPLETED, Executor, Future, wait
from pathlib import Path
from typing import Protocol, TypeVar, runtime_checkable

from pydantic import BaseModel

from labcal.run.made import make_folder
from labcal.run.outputs import write_file
from labcal.run.progress import Progress


@runtime_checkable  # so that tests can check annotations
class Case(Protocol):
    """A piece of work with a name of its own."""

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
    OutputError
        A result cannot be written.
    """
    make_folder(folder)
    files = {case.key: folder / f"{case.key}.json" for case in cases}
    missing = [case for case in cases if not files[case.key].exists()]
    progress.start("cases", len(cases))
    progress.advance(len(cases) - len(missing))
    pending: dict[Future[R], C] = {}

    def keep(done: Iterable[Future[R]]) -> None:
        for future in done:
            text = future.result().model_dump_json(indent=2) + "\n"
            write_file(files[pending.pop(future).key], text, force=True)
            progress.advance()

    for case in missing:
        pending[executor.submit(work, case)] = case
        keep(wait(pending, timeout=0).done)  # an executor without processes has finished it already
    while pending:
        keep(wait(pending, return_when=FIRST_COMPLETED).done)
    return [result_type.model_validate_json(files[case.key].read_bytes()) for case in cases]
