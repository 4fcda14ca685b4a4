"""Executors for independent cases, serial or over processes, with the interface of the standard library."""

from collections.abc import Callable, Iterator, Sequence
from concurrent.futures import Executor, Future, as_completed
from contextlib import contextmanager
from typing import ParamSpec, TypeVar

from labcal.arguments import whole_number
from labcal.run.main_guard import end_unguarded_worker, refuse_unguarded
from labcal.run.pool import WorkerPool

Arguments = ParamSpec("Arguments")
Result = TypeVar("Result")


class SerialExecutor(Executor):
    """An executor that runs each case at once, in the caller's own thread."""

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
    """Yield an executor, and cancel what it has not begun if the caller fails.

    Worker processes are started afresh (*spawn*), so that none inherits the state of a renderer or of
    threads. A program that asks for more than one must therefore keep its start under
    ``if __name__ == "__main__"``. They end when this process ends, whatever ends it; one that ends before its
    time is replaced (see `WorkerPool`).

    Parameters
    ----------
    workers : int
        1 runs everything in this process. There are never more processes than cases.

    Raises
    ------
    InputError
        There are no workers, or the program lacks that guard.
    """
    workers = whole_number(workers, "workers", 1)
    if workers == 1:
        end_unguarded_worker()
        yield SerialExecutor()
        return
    with open_pool(workers) as pool:
        yield pool


@contextmanager
def open_pool(workers: int) -> Iterator[WorkerPool]:
    """Yield a pool of processes, also of a single one; see :func:`open_executor`."""
    refuse_unguarded()
    pool = WorkerPool(workers)
    try:
        yield pool
    except BaseException as error:
        if not isinstance(error, Exception):  # interrupted: what is begun is not waited for
            pool.kill()
        raise
    finally:
        pool.shutdown(cancel_futures=True)


def finished(
    executor: Executor, work: Callable[..., Result], cases: Sequence[tuple[object, ...]]
) -> Iterator[tuple[int, Future[Result]]]:
    """Submit cases, and yield the index and the future of each as soon as it is finished.

    Parameters
    ----------
    executor : Executor
    work : callable
        A function of the module level, so that other processes find it.
    cases : sequence of tuple
        The arguments of each case.
    """
    pending = {}
    for number, arguments in enumerate(cases):
        future = executor.submit(work, *arguments)
        if future.done():  # an executor without processes
            yield number, future
        else:
            pending[future] = number
    for future in as_completed(pending):
        yield pending[future], future
