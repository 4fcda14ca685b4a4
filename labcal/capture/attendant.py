"""The interface of an attendant, who says when the next set is taken and when there are enough."""

from typing import Protocol, runtime_checkable

from labcal.capture.source import FrameSet


@runtime_checkable  # so that tests can check annotations
class Attendant(Protocol):
    """Stands beside a capture: each set is taken when it says so, and it hears what became of it."""

    def wait(self, request: str, views: int) -> bool:
        """Return when the next set is to be taken.

        Parameters
        ----------
        request : str
            What a person is to do for it.
        views : int
            Views that are in the shoot.

        Returns
        -------
        bool
            False where no more is to be taken.
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
