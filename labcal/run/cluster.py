"""A cluster of Dask, as an executor; the only file that uses Dask."""

import logging
from collections.abc import Iterator, Sequence
from concurrent.futures import Future
from contextlib import contextmanager
from functools import partial
from typing import Any

from distributed import Client, KilledWorker

from labcal.errors import DeviceError, WorkerError
from labcal.run.cluster_address import LOCAL, require_address
from labcal.run.cluster_executor import ClusterExecutor
from labcal.run.cluster_local import local_cluster
from labcal.run.cluster_work import Installation, mismatch, perform

ANSWER_S = 8.0
"""Time within which a scheduler has to answer."""
_CLOSE_S = 2.0


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
    """Silence Dask's own messages: lost connections are dealt with here."""
    logger = logging.getLogger("distributed")
    before = logger.level
    logger.setLevel(logging.CRITICAL + 1)
    try:
        yield
    finally:
        logger.setLevel(before)


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
            self._client = Client(address, timeout=ANSWER_S, set_as_default=False, name="labcal")
        except Exception as error:
            reason = " ".join(str(error).split()) or type(error).__name__
            raise DeviceError(
                f"No Dask scheduler answers at {address} within {ANSWER_S:g} s ({reason}). See whether "
                "it runs ('dask scheduler' starts one) and whether its port can be reached from here."
            ) from error
        self._executor = self._client.get_executor(pure=False, allow_other_workers=False)

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
        return frozenset(self._client.scheduler_info(n_workers=-1)["workers"])

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
        done = self._executor.submit(perform, case, workers=[*workers])

        def hand_on(done: Future[bytes]) -> None:
            error = None if done.cancelled() else done.exception()
            if done.cancelled():
                sent.cancel()
            elif isinstance(error, KilledWorker):
                sent.set_exception(WorkerError(f"at {error.last_worker.address}, whose log may tell more"))
            elif error is not None:
                sent.set_exception(error)
            else:
                sent.set_result(done.result())

        done.add_done_callback(hand_on)
        return sent

    def close(self) -> None:
        """Leave the cluster; cases that are not begun are cancelled."""
        self._client.close(timeout=_CLOSE_S)
