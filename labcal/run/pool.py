"""A pool of worker processes that continues when one of them is killed."""

import contextlib
import pickle
from collections.abc import Callable, Iterator, Sequence
from concurrent.futures import Executor, Future, ThreadPoolExecutor
from copy import copy
from functools import partial
from queue import LifoQueue
from threading import Lock
from typing import Any, ParamSpec, TypeVar

from labcal.errors import LabcalError, WorkerError, WorkersEndError
from labcal.run.process_exit import exit_in_words, may_be_external
from labcal.run.worker import ProcessEndedError, Worker

Arguments = ParamSpec("Arguments")
Result = TypeVar("Result")

TRIES_WITH_OTHERS = 2
"""Number of tries of a case while others run; then it runs alone, since others may need the memory."""
TRIES_ALONE = 3
"""Number of tries alone if the process was killed, perhaps from outside; if it crashed, there is one."""
CASES_AHEAD = 4
"""Number of cases for each worker that are submitted before one is finished, so that none waits."""
MOST_FAILED = 5
"""Number of failed cases, with none done, after which the cases cannot be the reason."""


class WorkerPool(Executor):
    """An executor that spreads cases over processes, each a `ProcessPoolExecutor` of its own.

    A thread drives each of them, so a process that ends loses only its own case. That case is tried again in
    a new process, first while others run, at last alone. If it ends that process, too, it has failed: its
    future raises `WorkerError`, and the other cases continue.

    Parameters
    ----------
    workers : int
        The most processes; they are started as cases come in.
    """

    def __init__(self, workers: int) -> None:
        self._workers = [Worker() for _ in range(workers)]
        self._idle: LifoQueue[Worker] = LifoQueue()
        for worker in self._workers:
            self._idle.put(worker)
        self._threads = ThreadPoolExecutor(workers, "labcal-worker")
        self.window = CASES_AHEAD * workers
        """The number of cases to submit at a time."""
        self._one_alone = Lock()
        self._any_done = False
        self._failed_count = 0
        self._failure: LabcalError | None = None
        """The error because of which no further case is tried."""

    def submit(
        self, fn: Callable[Arguments, Result], /, *args: Arguments.args, **kwargs: Arguments.kwargs
    ) -> Future[Result]:
        """Run a case in the next free process, and return its future.

        The future raises what `fn` raises; `WorkerError` where the case ends every process that tries it;
        `InputError` or `DeviceError` where processes cannot be started, or all end.
        """
        return self._threads.submit(self._result_of, partial(fn, *args, **kwargs))

    def shutdown(self, wait: bool = True, *, cancel_futures: bool = False) -> None:  # noqa: FBT001, FBT002 -- the base class's
        """End the processes when the cases that are begun are done; see :meth:`Executor.shutdown`."""
        try:
            self._threads.shutdown(wait=wait, cancel_futures=cancel_futures)
            if wait:
                _close(self._workers)
        except BaseException:  # interrupted while it waits
            self.kill()
            raise

    def kill(self) -> None:
        """End the processes at once, and cancel all cases."""
        self._threads.shutdown(wait=False, cancel_futures=True)
        for worker in self._workers:
            worker.kill()

    def _result_of(self, case: Callable[[], Result]) -> Result:
        """Return the result of a case; runs in a thread of the pool."""
        pickled = pickle.dumps(case)
        for _ in range(TRIES_WITH_OTHERS):
            with self._borrowed(1) as (worker,), contextlib.suppress(ProcessEndedError):
                result: Result = self._tried(worker, pickled)
                return result
        # Two that wait for all workers, each with some of them, would wait for ever.
        with self._one_alone, self._borrowed(len(self._workers)) as workers:
            _close(workers)
            tries = 0
            while True:
                tries += 1
                try:
                    result = self._tried(workers[0], pickled)
                except ProcessEndedError as ended:
                    if tries == TRIES_ALONE or not may_be_external(ended.status):
                        raise self._failed(exit_in_words(ended.status)) from ended
                else:
                    return result

    def _tried(self, worker: Worker, case: bytes) -> Any:  # noqa: ANN401 -- whatever the case returns
        """Return the result of a pickled case from one process."""
        if self._failure is not None:
            raise copy(self._failure)  # for each future one of its own
        try:
            worker.open()
        except LabcalError as error:
            self._failure = error
            raise
        answer = worker.call(case)
        self._any_done = True
        return pickle.loads(answer)  # noqa: S301 -- from a process of this pool

    def _failed(self, how: str) -> WorkerError:
        """Return the error of a case that has failed; record if all have failed so far."""
        self._failed_count += 1  # by one thread at a time: no case but this one is tried now
        if self._failed_count >= MOST_FAILED and not self._any_done:
            self._failure = WorkersEndError(self._failed_count, how)
        return WorkerError(how)

    @contextlib.contextmanager
    def _borrowed(self, count: int) -> Iterator[Sequence[Worker]]:
        """Yield `count` workers for exclusive use; wait until they are free."""
        workers: list[Worker] = []
        try:
            while len(workers) < count:
                workers.append(self._idle.get())
            yield workers
        finally:
            for worker in workers:
                self._idle.put(worker)


def _close(workers: Sequence[Worker]) -> None:
    """End idle processes together, and wait until they have ended."""
    for worker in workers:
        worker.dismiss()
    for worker in workers:
        worker.join()
