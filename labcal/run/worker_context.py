"""The start of a worker process, and the queues to it."""

import signal
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from multiprocessing.context import SpawnContext, SpawnProcess
from multiprocessing.queues import SimpleQueue
from typing import Any

from labcal.run.main_guard import WORKER_NAME, lost_script_left_out


class WorkerContext(SpawnContext):
    """The context in which a `ProcessPoolExecutor` makes its process and its queues.

    Processes are started afresh (*spawn*), so that none inherits the state of a renderer or of threads.
    """

    def __init__(self) -> None:
        self.process: SpawnProcess | None = None
        """The process; None before it is started."""
        self._results: _ResultQueue | None = None

    def Process(self, *, target: Callable[..., object], args: tuple[Any, ...]) -> SpawnProcess:  # type: ignore[override]
        """Make the process under its name."""
        self.process = _WorkerProcess(target=target, args=args, name=WORKER_NAME)
        return self.process

    def SimpleQueue(self) -> "_ResultQueue":
        """Make the queue for results."""
        self._results = _ResultQueue(ctx=self.get_context())
        return self._results

    def leave_writing(self) -> None:
        """Leave the writing end of the queue of results to the process.

        As long as the parent has it, too, it would wait for ever for the rest of a result within which the
        process was killed.
        """
        if self._results is not None:
            self._results.close_writer()


class _WorkerProcess(SpawnProcess):
    """A process that ignores Ctrl-C from its start, and that needs no script if that is lost."""

    def start(self) -> None:
        """Start the process."""
        with _interrupts_blocked(), lost_script_left_out():
            super().start()


@contextmanager
def _interrupts_blocked() -> Iterator[None]:
    """Block Ctrl-C in this thread, which a new process inherits, if the system has signal masks."""
    if not hasattr(signal, "pthread_sigmask"):
        yield
        return
    before = signal.pthread_sigmask(signal.SIG_BLOCK, {signal.SIGINT})
    try:
        yield
    finally:
        signal.pthread_sigmask(signal.SIG_SETMASK, before)


class _ResultQueue(SimpleQueue[Any]):
    """A queue whose writing end can be closed."""

    def close_writer(self) -> None:
        """Close this process's copy of the writing end."""
        self._writer.close()  # type: ignore[attr-defined] # typeshed leaves it out
