"""How a worker process ended, in words."""

import signal

_CRASHES = {"SIGABRT", "SIGBUS", "SIGFPE", "SIGILL", "SIGSEGV", "SIGSYS", "SIGTRAP"}
OUT_OF_MEMORY_STATUS = 86
"""A worker process ends itself with this exit status where memory is refused to it."""
_WINDOWS_CRASH = 0xC0000000
"""Exit statuses of Windows from here on are those of an exception that nobody handled."""


_FOREIGN = {"SIGHUP", "SIGINT", "SIGKILL", "SIGTERM"}


def may_be_foreign(status: int | None) -> bool:
    """Tell whether a process may have been ended by somebody else, who had nothing to do with its work."""
    return status is not None and status < 0 and _signal_name(-status) in _FOREIGN


def ending_in_words(status: int | None) -> str:
    """Return how a process ended, as a clause without a verb: ``"killed by SIGKILL, ..."``.

    Parameters
    ----------
    status : int or None
        The exit status, negative where a signal ended the process; None where it is not known.
    """
    if status is None:
        return "without a word"
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
