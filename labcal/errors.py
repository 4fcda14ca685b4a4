"""Errors that labcal raises on misuse: one root class, and a few subclasses.

Expected misfortune (a lost dot, an unusable picture, a solver that stopped) is data with a reason and no
exception.
"""

from collections.abc import Iterable
from difflib import get_close_matches

from labcal.wording import clipped, listed, shortened


class LabcalError(Exception):
    """Root of every exception that labcal raises on purpose.

    Parameters
    ----------
    message : str
        What was given, what was expected and how to mend it. Of one that is very long the middle is left out,
        since what a file holds may be repeated in it.

    Examples
    --------
    >>> from labcal import LabcalError, load_target
    >>> try:
    ...     load_target("rings-10x9")
    ... except LabcalError as error:
    ...     print(error)
    There is no target named 'rings-10x9'. Did you mean 'rings-10x8'? Known: ...
    """

    def __init__(self, message: str = "") -> None:
        super().__init__(shortened(message))


class InputError(LabcalError, ValueError):
    """A value, a file or a name that cannot be used; the message says what to do.

    It is a :class:`ValueError`, too.

    Examples
    --------
    >>> from pathlib import Path
    >>> from labcal import InputError, read_rig
    >>> try:
    ...     read_rig(Path("nowhere.json"))
    ... except InputError as error:
    ...     print(isinstance(error, ValueError))
    True
    """


class InputTypeError(LabcalError, TypeError):
    """An argument of the wrong type."""


class OutputError(LabcalError, OSError):
    """A file or folder that cannot be written, or that would be overwritten."""


class DiskFullError(OutputError):
    """The disk is full; what was begun has been removed."""


class DeviceError(LabcalError, RuntimeError):
    """A device or a library of this machine that failed or is missing."""


class WorkerError(DeviceError):
    """A case that ends each worker process that tries it, the last one alone; no fault of other cases.

    Parameters
    ----------
    how : str
        How the last process ended, for example ``"crashed with SIGSEGV"``.
    """

    def __init__(self, how: str) -> None:
        super().__init__(how)
        self.how = how

    def __str__(self) -> str:
        return f"Each worker process that tried this case ended, the last one alone: {self.how}."


class WorkersEndError(DeviceError):
    """All cases so far ended each worker process that tried them, so that the cases cannot be the reason.

    Parameters
    ----------
    count : int
        Number of cases.
    how : str
        How the last process ended, for example ``"with exit status 3"``.
    """

    def __init__(self, count: int, how: str) -> None:
        super().__init__(
            f"All worker processes end: the first {count} cases ended each process that tried them, the last "
            f"one {how}. See with 'labcal doctor' whether the libraries work on this machine, and whether "
            "there is enough memory."
        )
        self.count = count
        self.how = how

    def __reduce__(self) -> tuple[type["WorkersEndError"], tuple[int, str]]:
        """Let it be copied and pickled."""
        return type(self), (self.count, self.how)


_MOST_KNOWN = 40


class UnknownNameError(InputError):
    """A name that is not among those known; the message offers the nearest one.

    Parameters
    ----------
    kind : str
        What the name should have named, for example ``"target"``.
    given : str
        The name as given.
    known : iterable of str
        All names that would have been understood.
    """

    def __init__(self, kind: str, given: str, known: Iterable[str]) -> None:
        given = given if isinstance(given, str) else repr(given)
        names, short = sorted(known), clipped(given)
        nearest = get_close_matches(short, names, n=1, cutoff=0.5)
        hint = f" Did you mean '{clipped(nearest[0])}'?" if nearest else ""
        super().__init__(f"There is no {kind} named '{short}'.{hint} Known: {listed(names, _MOST_KNOWN)}.")
        self._parts = (kind, given, tuple(names))

    def __reduce__(self) -> tuple[type["UnknownNameError"], tuple[str, str, tuple[str, ...]]]:
        """Let it be pickled, so that a worker process can hand it on."""
        return type(self), self._parts
