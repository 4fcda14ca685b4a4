"""One worker process, started when it is first needed and again after it has ended."""

import os
from concurrent.futures import CancelledError, ProcessPoolExecutor
from concurrent.futures.process import BrokenProcessPool

from labcal.errors import DeviceError, LabcalError
from labcal.run.main_guard import UNGUARDED_STATUS, advice_on_script, unguarded_script
from labcal.run.process_exit import exit_in_words, may_be_external
from labcal.run.worker_context import WorkerContext
from labcal.run.worker_process import perform, prepare

STARTS = 10
"""Number of processes killed before they are ready, after which starting is given up."""


class ProcessEndedError(Exception):
    """The process ended while a case was in it; `status` is its exit status, negative for a signal."""

    def __init__(self, status: int | None) -> None:
        super().__init__(status)
        self.status = status


class Worker:
    """A pool of one process, so that it is known which case a process had when it ended.

    It is used by one thread at a time; only :meth:`kill` may be called from any.
    """

    def __init__(self) -> None:
        self._pool: ProcessPoolExecutor | None = None
        self._context = WorkerContext()
        self._killed = False

    def open(self) -> None:
        """Start a process where there is none, and wait until it is ready.

        A failed start is thereby not attributed to a case.

        Raises
        ------
        InputError
            The script lacks the guard of its main module.
        DeviceError
            No process can be started.
        CancelledError
            The worker was killed.
        """
        if self._killed:
            raise CancelledError
        if self._context.process is not None and not self._context.process.is_alive():
            self._discard()  # it ended while it had nothing to do
        starts = 0
        while self._pool is None:
            starts += 1
            try:
                self._start()
            except ProcessEndedError as ended:
                if starts == STARTS or not may_be_external(ended.status):
                    raise _not_started(ended.status) from None

    def call(self, case: bytes) -> bytes:
        """Return the pickled result of a pickled case (see :func:`perform`), or raise what it raises.

        The process must be open.

        Raises
        ------
        ProcessEndedError
            The process ended meanwhile; the next call needs a new one.
        CancelledError
            The worker was killed.
        """
        if self._pool is None:
            raise RuntimeError("Worker.call comes after Worker.open.")
        try:
            return self._pool.submit(perform, case).result()
        except BrokenProcessPool as error:
            raise ProcessEndedError(self._discard()) from error

    def dismiss(self) -> None:
        """Ask the process to end, without waiting for it."""
        if self._pool is not None:
            self._pool.shutdown(wait=False)
        self._pool = None

    def join(self) -> None:
        """Wait until the process that was dismissed has ended."""
        if self._context.process is not None:
            self._context.process.join()
        self._context = WorkerContext()

    def kill(self) -> None:
        """End the process at once, and start no other one."""
        self._killed = True
        process = self._context.process
        if process is not None and process.pid is not None:  # else the thread that starts it sees to it
            process.kill()

    def _start(self) -> None:
        """Start a process and wait until it is ready; raise `ProcessEndedError` where it ends before."""
        self._context = WorkerContext()
        self._pool = ProcessPoolExecutor(1, mp_context=self._context, initializer=prepare)
        try:
            ready = self._pool.submit(os.getpid)
            if self._killed:
                self.kill()
            ready.result()
        except BrokenProcessPool as error:
            raise ProcessEndedError(self._discard()) from error
        except (OSError, RuntimeError) as error:  # no process, no thread, no file to be had
            self.kill()
            raise DeviceError(f"No worker process can be started: {error}. Use fewer workers.") from error
        self._context.leave_writing()

    def _discard(self) -> int | None:
        """Forget a process that has ended, and return its exit status."""
        process, pool = self._context.process, self._pool
        self._pool, self._context = None, WorkerContext()
        if pool is not None:
            pool.shutdown()  # waits for the process
        if self._killed:
            raise CancelledError
        return None if process is None else process.exitcode


def _not_started(status: int | None) -> LabcalError:
    """Return the error of a process that ended before its first case."""
    if status == UNGUARDED_STATUS:
        return unguarded_script()
    if may_be_external(status):
        return DeviceError(
            f"No worker process can be started: {STARTS} ended before their first case, the last one "
            f"{exit_in_words(status)}. Free memory, or use fewer workers."
        )
    return DeviceError(
        f"No worker process can be started: one ended before its first case, {exit_in_words(status)}. Its "
        f"output is above. {advice_on_script()}".rstrip()
    )
