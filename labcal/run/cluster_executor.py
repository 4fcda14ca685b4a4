"""An executor that keeps its cases when workers, the scheduler or the connection to it are lost."""

import logging
import pickle
import time
from collections import deque
from collections.abc import Callable
from concurrent.futures import CancelledError, Executor, Future
from copy import copy
from dataclasses import dataclass, field
from functools import partial
from threading import Event, RLock, Thread
from typing import Any, ParamSpec, TypeVar

import cloudpickle

from labcal.errors import DeviceError, LabcalError, WorkerError
from labcal.run.cluster_connection import Connection

Arguments = ParamSpec("Arguments")
Result = TypeVar("Result")

LOOK_S = 0.5
"""Time between two looks at what workers there are."""
PATIENCE_S = 60.0
"""Time for which a lost scheduler, or a cluster without any worker that can be used, is waited for."""
LOSSES_WITH_OTHERS, LOSSES_ALONE = 3, 2
"""Times that the workers of a case may go, beside other cases and then alone, before it is given up."""
CASES_AHEAD = 8
"""Number of cases for each worker that are sent before one is finished, so that none waits."""
_LOG = logging.getLogger(__name__)


@dataclass(eq=False)
class _Case:
    """A case that has no result yet."""

    future: Future[Any]
    """The one that the caller has."""
    pickled: bytes = b""
    workers: frozenset[str] = field(default_factory=frozenset)
    """Those that it was sent to."""
    losses: int = 0
    """Times that all of these workers have gone."""
    suspect: bool = False
    """True if it was in several workers that ended; it is done when no other case is there."""


class ClusterExecutor(Executor):
    """An executor of a cluster whose workers come and go.

    A thread looks at the workers. Those with the same installation as this process do cases; of each other
    one there is one warning in the log. What a lost worker or scheduler had is sent again. A case that ended
    several workers is sent again when no other case is there: neighbours of it may have been in them, too.

    Parameters
    ----------
    connect : callable
        Returns a connection, or raises `DeviceError`.
    name : str
        The cluster's, for messages.

    Raises
    ------
    DeviceError
        No scheduler answers.
    """

    def __init__(self, connect: Callable[[], Connection], name: str) -> None:
        self._connect = connect
        self._name = name
        self._lock = RLock()
        self._waiting: deque[_Case] = deque()
        self._suspects: deque[_Case] = deque()
        self._sent: dict[Future[bytes], _Case] = {}
        self._fit: frozenset[str] = frozenset()
        self._unfit: dict[str, str] = {}
        self._failure: LabcalError | None = None
        self._ended = Event()
        self._to_do = Event()
        self._last_fit = time.monotonic()
        self._connection = connect()
        self._watch = Thread(target=self._watching, name="labcal-cluster", daemon=True)
        self._watch.start()

    @property
    def window(self) -> int:
        """The number of cases to submit at a time."""
        return CASES_AHEAD * max(1, len(self._fit))

    def submit(
        self, fn: Callable[Arguments, Result], /, *args: Arguments.args, **kwargs: Arguments.kwargs
    ) -> Future[Result]:
        """Send a case to the cluster, and return its future.

        The future raises what `fn` raises; `WorkerError` where the case ends the workers that try it;
        `DeviceError` where the cluster is lost.
        """
        if self._ended.is_set():
            raise RuntimeError("The cluster's executor was shut down.")
        case = _Case(Future())
        try:
            case.pickled = cloudpickle.dumps(partial(fn, *args, **kwargs))
        except Exception as error:  # noqa: BLE001 -- whatever its class does; as other executors do
            case.future.set_exception(error)
            return case.future
        with self._lock:
            if self._failure is not None:
                case.future.set_exception(copy(self._failure))
            else:
                self._waiting.append(case)
        self._send()
        return case.future

    def shutdown(self, wait: bool = True, *, cancel_futures: bool = False) -> None:  # noqa: FBT001, FBT002 -- the base class's
        """Leave the cluster when all cases are done, or at once; see :meth:`Executor.shutdown`.

        Cases that are begun cannot be stopped on a cluster; their results are dropped.
        """
        if wait and not cancel_futures:
            for case in self._unfinished():
                case.future.exception()
        self._ended.set()
        self._to_do.set()
        self._watch.join()
        self._fail(CancelledError())
        self._connection.close()

    def _unfinished(self) -> list[_Case]:
        with self._lock:
            return [*self._waiting, *self._suspects, *self._sent.values()]

    def _send(self) -> None:
        """Send what is waiting: first the cases above suspicion, each suspect when nothing else is there."""
        with self._lock:
            alone = any(case.suspect for case in self._sent.values())
            while self._waiting and self._fit and not alone:
                self._send_one(self._waiting.popleft())
            if self._suspects and self._fit and not self._sent:
                self._send_one(self._suspects.popleft())

    def _send_one(self, case: _Case) -> None:
        if not case.future.running() and not case.future.set_running_or_notify_cancel():
            return
        case.workers = self._fit
        sent = self._connection.submit(case.pickled, sorted(case.workers))
        self._sent[sent] = case
        sent.add_done_callback(self._came_back)

    def _came_back(self, sent: Future[bytes]) -> None:
        """Hand on a result, or put a case that was lost back; runs in a thread of the connection."""
        with self._lock:
            case = self._sent.pop(sent, None)
            if case is None:  # it has been put back already
                return
            error = CancelledError() if sent.cancelled() else sent.exception()
            if isinstance(error, CancelledError):
                self._put_back(case)
                return
            if isinstance(error, WorkerError) and not case.suspect:
                case.suspect = True
                self._put_back(case)
                return
        self._to_do.set()
        if error is not None:
            case.future.set_exception(error)
        else:
            case.future.set_result(pickle.loads(sent.result()))  # noqa: S301 -- from a worker, see there

    def _put_back(self, case: _Case) -> None:
        (self._suspects if case.suspect else self._waiting).appendleft(case)
        self._to_do.set()

    def _watching(self) -> None:
        """Look at the cluster again and again; the work of a thread of its own."""
        while not self._ended.is_set():
            try:
                if not self._connection.is_open():
                    self._reconnect()
                self._look()
            except LabcalError as error:
                self._fail(error)
                return
            except OSError:  # the connection broke just now
                pass
            self._send()
            self._to_do.wait(LOOK_S)
            self._to_do.clear()

    def _look(self) -> None:
        """Find out which workers can be used, and take back what was sent to none that is still there."""
        there = self._connection.workers()
        unknown = sorted(there - self._fit - self._unfit.keys())
        found = self._connection.refusals(unknown) if unknown else {}
        refusals = {worker: reason for worker, reason in found.items() if reason is not None}
        for worker, reason in refusals.items():
            _LOG.warning("The worker %s of the cluster is left out: %s.", worker, reason.rstrip("."))
        with self._lock:
            self._unfit = {
                worker: reason for worker, reason in (self._unfit | refusals).items() if worker in there
            }
            self._fit = there & (self._fit | (found.keys() - refusals.keys()))
            lost = [sent for sent, case in self._sent.items() if not case.workers & self._fit]
            cases = [self._sent.pop(sent) for sent in lost]
        for sent in lost:
            sent.cancel()
        for case in cases:
            self._lost(case)
        if self._fit:
            self._last_fit = time.monotonic()
        elif time.monotonic() > self._last_fit + PATIENCE_S:
            raise self._no_worker()

    def _lost(self, case: _Case) -> None:
        """Put back a case whose workers have all gone, or give it up."""
        case.losses += 1
        case.suspect = case.suspect or case.losses > LOSSES_WITH_OTHERS
        if case.losses > LOSSES_WITH_OTHERS + LOSSES_ALONE:
            case.future.set_exception(
                WorkerError(f"at {', '.join(sorted(case.workers))}, whose log may tell more")
            )
            return
        with self._lock:
            self._put_back(case)

    def _no_worker(self) -> DeviceError:
        """Return the error for a cluster on which nothing can be done."""
        reasons = [f"{worker}: {reason}" for worker, reason in list(self._unfit.items())[:3]]
        why = f"those that are there are left out ({'; '.join(reasons)})" if reasons else "it has none"
        return DeviceError(
            f"The cluster {self._name} has had no worker that can be used for {PATIENCE_S:g} s: {why}. Start "
            f"workers with the same versions as here ('dask worker {self._name} --nthreads 1'). "
            "Finished results are kept: the same command resumes from there."
        )

    def _reconnect(self) -> None:
        """Connect anew, and take back all that was sent."""
        self._connection.close()
        with self._lock:
            self._fit, self._unfit = frozenset(), {}
            for sent in list(self._sent):
                self._put_back(self._sent.pop(sent))
        deadline = time.monotonic() + PATIENCE_S
        while not self._ended.is_set():
            try:
                self._connection = self._connect()
            except DeviceError as error:
                if time.monotonic() > deadline:
                    raise DeviceError(
                        f"The scheduler {self._name} is lost, and was waited for {PATIENCE_S:g} s. Start it "
                        "again. Finished results are kept: the same command resumes from there."
                    ) from error
                self._ended.wait(LOOK_S)
            else:
                self._last_fit = time.monotonic()
                return

    def _fail(self, error: LabcalError | CancelledError) -> None:
        """End all cases with an error, also those that come."""
        with self._lock:
            cases = self._unfinished()
            self._failure = error if isinstance(error, LabcalError) else self._failure
            self._waiting.clear()
            self._suspects.clear()
            self._sent.clear()
        for case in cases:
            if not case.future.cancel():
                case.future.set_exception(copy(error))
