"""The end of an error: a message, an exit status and, with ``--json``, a document."""

import errno
import os
import sys
import traceback
from dataclasses import dataclass

from labcal.calibrate.agreement.finding import ContradictionError
from labcal.cli.session import Session
from labcal.cli.status import ExitStatus
from labcal.cli.termination import Terminated
from labcal.errors import DeviceError, DiskFullError, LabcalError
from labcal.report.inconsistent_result import InconsistentResult, contradiction_result
from labcal.wording import printable, shortened

TRACEBACK_VARIABLE = "LABCAL_TRACEBACK"
"""Set to 1, every error is shown with its traceback."""

# What the caller gave cannot be used; every other OSError is the machine's fault.
_UNUSABLE_PATH = {
    errno.EACCES,
    errno.EEXIST,
    errno.EISDIR,
    errno.ELOOP,
    errno.ENAMETOOLONG,
    errno.ENOENT,
    errno.ENOTDIR,
    errno.ENOTEMPTY,
    errno.EPERM,
    errno.EROFS,
}


@dataclass(frozen=True)
class Failure:
    """An error as the JSON document shows it."""

    kind: str
    message: str
    status: int


@dataclass(frozen=True)
class ContradictionFailure(Failure):
    """The same where cameras contradict each other, with the likely causes."""

    inconsistent: InconsistentResult


@dataclass(frozen=True)
class FailureDocument:
    """The JSON document of a command that failed."""

    error: Failure


def explain(error: BaseException) -> Failure:
    """Return the report of an error."""
    kind = type(error).__name__
    match error:
        case Terminated():
            message = "Terminated. The same command again resumes where its output allows it."
            status = ExitStatus.TERMINATED
        case KeyboardInterrupt():
            message = "Interrupted. The same command again resumes where its output allows it."
            status = ExitStatus.INTERRUPTED
        case DeviceError() | DiskFullError():
            message, status = str(error), ExitStatus.FAILED
        case LabcalError():
            message, status = str(error), ExitStatus.UNUSABLE
        case OSError(errno=number) if number in {errno.ENOSPC, errno.EDQUOT}:
            message = f"The disk is full: {_where(error)}. Free some space, or write somewhere else."
            status = ExitStatus.FAILED
        case OSError(errno=number) if number in _UNUSABLE_PATH:
            message, status = f"{_where(error)}.", ExitStatus.UNUSABLE
        case MemoryError():
            message = "The memory does not suffice. Try fewer --workers, or smaller pictures."
            status = ExitStatus.FAILED
        case _:
            message = f"labcal itself failed ({kind}: {error}). Set {TRACEBACK_VARIABLE}=1 to see where."
            status = ExitStatus.FAILED
    if isinstance(error, ContradictionError):
        return ContradictionFailure(kind, shortened(message), status, contradiction_result(error))
    return Failure(kind, shortened(message), status)


def report_failure(error: BaseException, session: Session) -> ExitStatus:
    """Report an error on stderr, and on stdout where JSON is wanted; return the exit status."""
    failure = explain(error)
    if os.environ.get(TRACEBACK_VARIABLE, "0") not in {"", "0"}:
        sys.stderr.write(printable("".join(traceback.format_exception(error))))
    session.fail(failure.message, FailureDocument(failure))
    return ExitStatus(failure.status)


def _where(error: OSError) -> str:
    """Return the file of an error from the operating system, if it has one, and what was wrong."""
    reason = error.strerror or str(error)
    return f"{error.filename}: {reason}" if error.filename else reason
