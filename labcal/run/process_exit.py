"""Exit statuses of worker processes, explained in words."""

import signal

_CRASHES = {"SIGABRT", "SIGBUS", "SIGFPE", "SIGILL", "SIGSEGV", "SIGSYS", "SIGTRAP"}
OUT_OF_MEMORY_STATUS = 86
"""The exit status with which a worker process ends itself when it cannot get memory."""
_WINDOWS_CRASH = 0xC0000000
"""The first exit status of Windows that means an unhandled exception."""


_FOREIGN = {"SIGHUP", "SIGINT", "SIGKILL", "SIGTERM"}


def may_be_external(status: int | None) -> bool:
    """Tell whether a process may have been ended from outside, independently of its work."""
    return status is not None and status < 0 and _signal_name(-status) in _FOREIGN


def exit_in_words(status: int | None) -> str:
    """Return a description of an exit as a clause without a verb: ``"killed by SIGKILL, ..."``.

    Parameters
    ----------
    status : int or None
        The exit status, negative where a signal ended the process; None where it is not known.
    """
    if status is None:
        return "for an unknown reason"
    if status < 0:
        name = _signal_name(-status)
        if name == "SIGKILL":
            return "killed by SIGKILL, which is what the system does when memory runs out"
        return f"crashed with {name}" if name in _CRASHES else f"ended by {name}"
    if status == OUT_OF_MEMORY_STATUS:
        return "out of memory"
    if status >= _WINDOWS_CRASH:
        return f"crashed with {status:#010x}"
    return f"with exit status {status}"


def _signal_name(number: int) -> str:
    """Return the name of a signal, or its number where it has none."""
    try:
        return signal.Signals(number).name
    except ValueError:
        return f"signal {number}"
