"""How independent cases are spread, serially or over processes: the standard library's own interface."""

import multiprocessing
from collections.abc import Callable, Iterator
from concurrent.futures import Executor, Future, ProcessPoolExecutor
from contextlib import contextmanager
from typing import ParamSpec, TypeVar

from labcal.errors import InputError

Arguments = ParamSpec("Arguments")
Result = TypeVar("Result")


class SerialExecutor(Executor):
    """Runs each case at once, in the caller's own thread."""

    def submit(
        self, fn: Callable[Arguments, Result], /, *args: Arguments.args, **kwargs: Arguments.kwargs
    ) -> Future[Result]:
        """Run the case and return its finished future."""
        future: Future[Result] = Future()
        try:
            future.set_result(fn(*args, **kwargs))
        except Exception as error:  # noqa: BLE001 -- a future hands on whatever its case raised
            future.set_exception(error)
        return future


@contextmanager
def open_executor(workers: int) -> Iterator[Executor]:
    """Give an executor, and end it with what it has not begun when the caller fails.

    Processes are started afresh (*spawn*), so that none inherits the state of a renderer or of threads. A
    program that asks for more than one must therefore keep its start under ``if __name__ == "__main__"``.

    Parameters
    ----------
    workers : int
        1 runs everything in this process.

    Raises
    ------
    InputError
        There are no workers.
    """
    if workers < 1:
        raise InputError(f"The number of workers must be at least 1, but is {workers}.")
    pool: Executor = SerialExecutor()
    if workers > 1:
        pool = ProcessPoolExecutor(workers, mp_context=multiprocessing.get_context("spawn"))
    try:
        yield pool
    finally:
        pool.shutdown(wait=True, cancel_futures=True)
