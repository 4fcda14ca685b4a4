"""The pace of this machine now, beside that of the machine on which durations were measured."""

import os
import time

import numpy as np

from labcal.run.threads import one_blas_thread

_REFERENCE_S = 0.0049
"""Processor time of `_work` on a core of an AMD EPYC of 2026, where the durations of cases were measured."""
_TRIES = 12
_LONGER = (300.0, 900.0)
"""Seconds from which on the load of five and of fifteen minutes tells more than that of one."""
BUSY = 1.3
"""Times the usual duration, from which on others use a machine noticeably."""


def core_pace() -> float:
    """Return the processor time of a piece of work on this machine over that on the reference machine.

    It takes a tenth of a second. The fastest of several tries counts: others disturb the caches.
    """
    with one_blas_thread():
        _work()  # the first time, libraries get ready
        return min(_processor_seconds() for _ in range(_TRIES)) / _REFERENCE_S


def crowding(workers: int, seconds: float) -> float:
    """Return the factor by which work takes longer since other programs use this machine; 1 if they do not.

    Programs that wait for a processor get equal shares of all of them. Their number is the mean of the last
    minute, or of the last five or fifteen for work that takes longer than that; 1 where the system does not
    report it (Windows).

    Parameters
    ----------
    workers : int
        Number of processes that are to be started.
    seconds : float
        Duration of the work without others.
    """
    try:
        others = os.getloadavg()[sum(seconds > limit for limit in _LONGER)]
    except (AttributeError, OSError):
        return 1.0
    return max(1.0, (others + workers) / max(workers, os.cpu_count() or 1))


def _processor_seconds() -> float:
    began = time.process_time()
    _work()
    return time.process_time() - began


def _work() -> float:
    """Compute as the fit of a method does: small matrices, and Python between them."""
    matrix = 2.0 * np.eye(120) + np.ones((120, 120))
    total = 0.0
    for _ in range(20):
        factor = np.linalg.cholesky(matrix)
        total += float(np.exp(-((factor - factor.T) ** 2)).sum())
        for number in range(2000):
            total += 0.5 * number
    return total
