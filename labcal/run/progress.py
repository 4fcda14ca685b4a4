"""Reports of progress of long work: an interface that the command line implements."""

from typing import Protocol, runtime_checkable

from labcal.arguments import wrong_type


@runtime_checkable  # so that tests can check annotations
class Progress(Protocol):
    """A receiver of reports of progress."""

    def start(self, label: str, total: int, done: int = 0) -> None:
        """Begin a piece of work of `total` steps, some of which an earlier run has done."""

    def advance(self, steps: int = 1) -> None:
        """Report steps as done."""


class NoProgress:
    """A receiver that ignores all reports."""

    def start(self, label: str, total: int, done: int = 0) -> None:
        """Do nothing."""

    def advance(self, steps: int = 1) -> None:
        """Do nothing."""


def progress_of(given: object) -> Progress:
    """Return the receiver that is given, or a silent one for None.

    Raises
    ------
    InputTypeError
        It has no methods ``start`` and ``advance``.
    """
    if given is None:
        return NoProgress()
    if isinstance(given, Progress):
        return given
    raise wrong_type(given, "an object with the methods start and advance", "progress")
