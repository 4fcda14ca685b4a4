"""The work of one case, wherever it is done: with one thread, timed, its result as text."""

import time
import traceback
from collections.abc import Callable
from dataclasses import dataclass
from threading import RLock
from typing import TypeVar

from pydantic import BaseModel

from labcal.errors import DeviceError, LabcalError
from labcal.run.case import Fault
from labcal.run.threads import one_thread

C = TypeVar("C")

_ONE_AT_A_TIME = RLock()
"""Switches to one thread hold for a whole process, in which a worker of Dask may have several threads."""


@dataclass(frozen=True)
class Done:
    """The end of a case as it is sent back."""

    text: str | None
    """The result as JSON; None where there is none."""
    reason: str | None
    seconds: float
    fault: Fault | None = None


def done(work: Callable[[C], BaseModel], case: C) -> Done:
    """Return the result of a case; raise what the work raises."""
    with _ONE_AT_A_TIME, one_thread():
        began = time.perf_counter()
        text = work(case).model_dump_json(indent=1)
        return Done(text, None, time.perf_counter() - began)


def done_or_reason(work: Callable[[C], BaseModel], case: C) -> Done:
    """Return the result of a case, or the reason why there is none."""
    began = time.perf_counter()
    try:
        return done(work, case)
    except MemoryError:  # the executor's affair: it may try again with more
        raise
    except LabcalError as error:
        fault = Fault.MACHINE if isinstance(error, DeviceError) else Fault.CASE
        return Done(None, str(error), time.perf_counter() - began, fault)
    except Exception as error:  # noqa: BLE001 -- one case must not end a sweep
        return Done(None, unexpected(error), time.perf_counter() - began, Fault.PROGRAM)


def unexpected(error: Exception) -> str:
    """Return the reason for an error that nobody meant, with the line of code that raised it."""
    lines = traceback.extract_tb(error.__traceback__)
    where = f" at {lines[-1].filename.rpartition('/')[2]}:{lines[-1].lineno}" if lines else ""
    return f"Unexpected error{where}: {type(error).__name__}: {error}"
