"""A connection to a cluster, as the executor needs it: an interface that `labcal.run.cluster` implements."""

from collections.abc import Sequence
from concurrent.futures import Future
from typing import Protocol, runtime_checkable


@runtime_checkable  # so that tests can check annotations
class Connection(Protocol):
    """A connection to a cluster; see `labcal.run.cluster.DaskConnection`."""

    def is_open(self) -> bool:
        """Tell whether the scheduler is still there."""

    def workers(self) -> frozenset[str]:
        """Return the addresses of the workers that are there; raise `OSError` where nobody answers."""

    def refusals(self, workers: Sequence[str]) -> dict[str, str | None]:
        """Return why workers cannot do cases, by address; None for those that can."""

    def submit(self, case: bytes, workers: Sequence[str]) -> Future[bytes]:
        """Let one of some workers do a pickled case; the future is cancelled when the connection breaks."""

    def close(self) -> None:
        """Leave the cluster; what was submitted is cancelled."""
