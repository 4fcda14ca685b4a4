"""A cluster of Dask, as an executor; the only file that uses Dask."""

import asyncio
import logging
from collections.abc import Awaitable, Iterator, Sequence
from concurrent.futures import CancelledError, Future
from contextlib import contextmanager
from functools import partial
from threading import Thread
from typing import Any

from distributed import Client, KilledWorker

from labcal.errors import DeviceError, WorkerError
from labcal.run.cluster_address import LOCAL, require_address
from labcal.run.cluster_executor import ClusterExecutor
from labcal.run.cluster_greeting import wait_for_greeting
from labcal.run.cluster_local import local_cluster
from labcal.run.cluster_work import Installation, mismatch, perform

ANSWER_S = 5.0
"""Time within which a scheduler has to answer."""
_CLOSE_S = 2.0
CONNECT_S = 2.0
"""Time for the rest of the connection."""


@contextmanager
def open_cluster(workers: int, scheduler: str) -> Iterator[ClusterExecutor]:
    """Yield the executor of a cluster, and cancel what is left if the caller fails.

    Parameters
    ----------
    workers : int
        The number of processes of a cluster that is started here.
    scheduler : str
        ``"local"`` starts a cluster of processes of this machine; else an address.

    Raises
    ------
    InputError
        It is no address.
    DeviceError
        No scheduler answers there, or the processes cannot be started.
    """
    if scheduler == LOCAL:
        with local_cluster(workers) as address, _connected(address) as executor:
            yield executor
        return
    with _connected(require_address(scheduler)) as executor:
        yield executor


@contextmanager
def _connected(address: str) -> Iterator[ClusterExecutor]:
    with _quiet_dask():
        executor = ClusterExecutor(partial(DaskConnection, address), address)
        try:
            yield executor
        finally:
            executor.shutdown(cancel_futures=True)


@contextmanager
def _quiet_dask() -> Iterator[None]:
    """Silence Dask's own messages: lost connections and workers are dealt with here."""
    known = [name for name in logging.Logger.manager.loggerDict if name.partition(".")[0] == "distributed"]
    levels = {name: logging.getLogger(name).level for name in known}
    for name in known:
        logging.getLogger(name).setLevel(logging.CRITICAL + 1)
    try:
        yield
    finally:
        for name, level in levels.items():
            logging.getLogger(name).setLevel(level)


class DaskConnection:
    """A connection to a scheduler; when it breaks, the futures of what was submitted are cancelled.

    Parameters
    ----------
    address : str

    Raises
    ------
    DeviceError
        No scheduler answers there.
    """

    def __init__(self, address: str) -> None:
        self._address = address
        try:
            wait_for_greeting(address, ANSWER_S)
            self._client = _client(address)
        except Exception as error:
            reason = " ".join(str(error).split()) or type(error).__name__
            raise DeviceError(
                f"No Dask scheduler answers at {address} within {ANSWER_S:g} s ({reason}). See whether "
                "it runs ('dask scheduler' starts one) and whether its port can be reached from here."
            ) from error
        if self._client.loop is None:
            raise RuntimeError("A client that is connected has a loop.")
        self._loop = self._client.loop

    def is_open(self) -> bool:
        """Tell whether the scheduler is still there."""
        return self._client.status == "running"

    def workers(self) -> frozenset[str]:
        """Return the addresses of the workers that are there.

        Raises
        ------
        OSError
            The scheduler does not answer.
        """
        if self._client.scheduler is None:
            raise ConnectionError("The client has left the scheduler.")
        # Not `scheduler_info`, which returns the client's last answer, perhaps to a question without workers.
        identity = self._client.sync(self._client.scheduler.identity, n_workers=-1)
        return frozenset(identity["workers"])

    def refusals(self, workers: Sequence[str]) -> dict[str, str | None]:
        """Return why workers cannot do cases, by address; None for those that can.

        Workers that have gone meanwhile are left out.
        """
        answers: dict[str, Any] = self._client.run(
            mismatch, Installation.here(), workers=[*workers], on_error="return"
        )
        return {
            worker: f"labcal cannot be loaded there ({answer})" if isinstance(answer, Exception) else answer
            for worker, answer in answers.items()
            if not isinstance(answer, OSError)
        }

    def submit(self, case: bytes, workers: Sequence[str]) -> Future[bytes]:
        """Let one of some workers do a pickled case.

        The future raises `WorkerError` where the case ended each worker that tried it; it is cancelled when
        the connection breaks.
        """
        sent: Future[bytes] = Future()
        task = self._client.submit(perform, case, pure=False, workers=[*workers], allow_other_workers=False)

        def give_up(sent: Future[bytes]) -> None:
            if sent.cancelled() and not task.done():
                task.cancel()

        sent.add_done_callback(give_up)
        self._loop.add_callback(_hand_on, task, sent)
        return sent

    def close(self) -> None:
        """Leave the cluster; cases that are not begun are cancelled."""
        self._client.close(timeout=_CLOSE_S)


def _client(address: str) -> Client:
    """Return a client, or raise in time, which Dask's own does not for whatever else may listen."""
    made: Future[Client] = Future()

    def make() -> None:
        try:
            made.set_result(Client(address, timeout=CONNECT_S, set_as_default=False, name="labcal"))
        except Exception as error:  # noqa: BLE001 -- Dask raises much, depending on what answers
            made.set_exception(error)

    Thread(target=make, name="labcal-cluster-connect", daemon=True).start()
    return made.result(CONNECT_S + 1.0)


async def _hand_on(task: Awaitable[bytes], sent: Future[bytes]) -> None:
    """Hand the end of a task on, in the loop of the client.

    Dask's own executor leaves a future without an end where a worker is lost after its result and before that
    was fetched.
    """
    result = b""
    error: Exception | None = None
    try:
        result = await task
    except (asyncio.CancelledError, CancelledError):
        sent.cancel()
    except KilledWorker as killed:
        error = WorkerError(f"at {killed.last_worker.address}, whose log may tell more")
    except Exception as raised:  # noqa: BLE001 -- whatever the case raises
        error = raised
    if not sent.set_running_or_notify_cancel():
        return
    if error is None:
        sent.set_result(result)
    else:
        sent.set_exception(error)
