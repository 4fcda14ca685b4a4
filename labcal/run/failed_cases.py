"""Cases that end every process that tries them, reported by name when all others are done."""

from collections.abc import Mapping

from labcal.errors import DeviceError, WorkerError

MOST_NAMED = 5
"""The number of cases that a message names."""


def raise_failed_cases(given_up: Mapping[str, WorkerError], count: int, kind: str, advice: str) -> None:
    """Raise an error that names the cases that could not be done, if there are any.

    Parameters
    ----------
    given_up : mapping of str to WorkerError
        By the name of the case.
    count : int
        All cases.
    kind : str
        The noun for cases, in the plural: ``"pictures"``.
    advice : str
        A sentence that says how to mend it.

    Raises
    ------
    DeviceError
        There are any; the message names them.
    """
    if not given_up:
        return
    named = [f"{name} ({error.how})" for name, error in list(given_up.items())[:MOST_NAMED]]
    if len(given_up) > len(named):
        named.append(f"{len(given_up) - len(named)} more")
    raise DeviceError(
        f"{len(given_up)} of {count} {kind} cannot be done: {', '.join(named)}. Each worker process that "
        f"tried one of them ended, the last one while no other was running. {advice} Finished results are "
        "kept: the same command resumes from there."
    )
