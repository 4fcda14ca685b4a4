"""Executors for independent cases, serial or over processes, with the interface of the standard library."""

from collections.abc import Callable, Iterable, Iterator
from concurrent.futures import Executor, Future
from contextlib import contextmanager
from queue import SimpleQueue
from typing import ParamSpec, TypeVar

from labcal.arguments import whole_number
from labcal.extras import optional_module
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
def open_executor(workers: int, scheduler: str | None = None) -> Iterator[Executor]:
    """Yield an executor, and cancel what it has not begun if the caller fails.

    Worker processes are started afresh (*spawn*), so that none inherits the state of a renderer or of
    threads. A program that asks for more than one must therefore keep its start under
    ``if __name__ == "__main__"``. They end when this process ends, whatever ends it; one that ends before its
    time is replaced (see `WorkerPool`).

    Parameters
    ----------
    workers : int
        1 runs everything in this process. There are never more processes than cases.
    scheduler : str, optional
        Of a Dask cluster that does the cases: an address, ``tcp://HOST:PORT``, or ``"local"`` for a cluster
        of `workers` processes of this machine (see `labcal.run.cluster`). A cluster at an address has workers
        of its own, whatever `workers` says.

    Raises
    ------
    InputError
        There are no workers, the program lacks that guard, or the scheduler's address is none.
    DeviceError
        The scheduler does not answer, or the libraries for a cluster are not installed.
    """
    workers = whole_number(workers, "workers", 1)
    if scheduler is not None:
        end_unguarded_worker()
        optional_module("distributed", "cluster")
        from labcal.run.cluster import open_cluster  # noqa: PLC0415 -- Dask takes a second to import

        with open_cluster(workers, scheduler) as cluster:
            yield cluster
        return
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


WINDOW = 64
"""The most cases that an executor has at a time, where it does not say how many it wants (`window`)."""


def finished(
    executor: Executor, work: Callable[..., Result], cases: Iterable[tuple[object, ...]]
) -> Iterator[tuple[int, Future[Result]]]:
    """Submit cases, and yield the index and the future of each as soon as it is finished.

    Only a few cases more than the executor works on are submitted at a time, so that thousands need no
    memory.

    Parameters
    ----------
    executor : Executor
    work : callable
        A function of the module level, so that other processes find it.
    cases : iterable of tuple
        The arguments of each case.
    """
    numbers: dict[Future[Result], int] = {}
    ended: SimpleQueue[Future[Result]] = SimpleQueue()
    for number, arguments in enumerate(cases):
        future = executor.submit(work, *arguments)
        numbers[future] = number
        future.add_done_callback(ended.put)
        while not ended.empty() or len(numbers) >= getattr(executor, "window", WINDOW):
            future = ended.get()
            yield numbers.pop(future), future
    while numbers:
        future = ended.get()
        yield numbers.pop(future), future
