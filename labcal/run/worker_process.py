"""The code of a worker process: preparation, and one case."""

import os
import pickle
import signal
from collections.abc import Callable

from labcal.run.parent_watch import end_with_parent
from labcal.run.process_exit import OUT_OF_MEMORY_STATUS


def prepare() -> None:
    """Prepare a process: it ends with its parent, and only the parent handles Ctrl-C."""
    signal.signal(signal.SIGINT, signal.SIG_IGN)
    end_with_parent()


def perform(case: bytes) -> bytes:
    """Perform a pickled case and return its pickled result.

    Where memory is refused to it, the process ends, as if the system had killed it: so the case is tried
    again with the memory that this process had, and at last with no other process there.

    Parameters
    ----------
    case : bytes
        A pickled function without arguments. It comes as bytes, as its result goes, since the pool breaks on
        what it cannot unpickle.

    Raises
    ------
    Exception
        What the function raises; as a `RuntimeError` where it cannot be sent to the parent.
    """
    work = pickle.loads(case)  # noqa: S301 -- from the parent
    try:
        return called(work)
    except MemoryError:
        os._exit(OUT_OF_MEMORY_STATUS)


def called(work: Callable[[], object]) -> bytes:
    """Return the pickled result of a function.

    Raises
    ------
    Exception
        What the function raises; as a `RuntimeError` where it cannot be sent to another process.
    """
    try:
        return pickle.dumps(work())
    except Exception as error:
        if _is_sendable(error):
            raise
        raise RuntimeError(f"{type(error).__name__}: {error}") from error


def _is_sendable(error: Exception) -> bool:
    """Tell whether an exception can be pickled and unpickled."""
    try:
        pickle.loads(pickle.dumps(error))  # noqa: S301 -- made here
    except Exception:  # noqa: BLE001 -- whatever its class does
        return False
    return True
