"""Cases that end each process that tries them: told by name when all others are done."""

from collections.abc import Mapping

from labcal.errors import DeviceError, WorkerError

MOST_NAMED = 5
"""So many cases are named; a message does not grow with their number."""


def refuse_given_up(given_up: Mapping[str, WorkerError], count: int, kind: str, advice: str) -> None:
    """Raise where cases were given up.

    Parameters
    ----------
    given_up : mapping of str to WorkerError
        By the name of the case.
    count : int
        All cases.
    kind : str
        What a case is, in the plural: ``"pictures"``.
    advice : str
        What to do about it: a sentence.

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
        f"tried one of them ended, the last one with no other beside it. {advice} What is done is kept: the "
        "same command goes on from there."
    )
