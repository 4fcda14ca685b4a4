"""The interface of an attendant, who says when the next set is taken and when there are enough."""

from dataclasses import dataclass
from typing import Protocol, runtime_checkable

from labcal.capture.source import FrameSet


@dataclass(frozen=True)
class DropView:
    """The wish that a view is taken out of the shoot."""

    view: str
    """Its name."""


@runtime_checkable  # so that tests can check annotations
class Attendant(Protocol):
    """Stands beside a capture: each set is taken when it says so, and it hears what became of it."""

    def wait(self, request: str, views: tuple[str, ...]) -> bool | DropView:
        """Return when the next set is to be taken, or a view is to leave the shoot.

        Parameters
        ----------
        request : str
            What a person is to do for it.
        views : tuple of str
            Names of the views that are in the shoot.

        Returns
        -------
        bool or DropView
            False where no more is to be taken. After a view was dropped it is asked again.
        """

    def dropped(self, view: str) -> None:
        """Hear that a view has left the shoot.

        Parameters
        ----------
        view : str
        """

    def heard(self, taken: FrameSet, view: str | None, reasons: tuple[str, ...]) -> None:
        """Hear of a set that was taken.

        Parameters
        ----------
        taken : FrameSet
        view : str or None
            Its name in the shoot; None where it was refused.
        reasons : tuple of str
            Why it was refused; empty where it was not.
        """
