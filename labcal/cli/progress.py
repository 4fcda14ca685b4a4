"""A progress bar in the terminal."""

from types import TracebackType

from rich.console import Console
from rich.progress import BarColumn, MofNCompleteColumn, Progress, TaskID, TextColumn, TimeRemainingColumn

_PERIOD_S = 1800.0
"""Time over which the speed is averaged: a step of a sweep may take minutes."""


class RichProgress:
    """Shows every piece of work as a bar; implements :class:`labcal.run.progress.Progress`."""

    def __init__(self, console: Console) -> None:
        self._bars = Progress(
            TextColumn("{task.description}", markup=False),
            BarColumn(),
            MofNCompleteColumn(),
            TimeRemainingColumn(elapsed_when_finished=True),
            console=console,
            speed_estimate_period=_PERIOD_S,
        )
        self._current: TaskID | None = None

    def __enter__(self) -> "RichProgress":
        """Take hold of the terminal's last lines."""
        self._bars.start()
        return self

    def __exit__(
        self, kind: type[BaseException] | None, error: BaseException | None, trace: TracebackType | None
    ) -> None:
        """Give the terminal back."""
        self._bars.stop()

    def start(self, label: str, total: int, done: int = 0) -> None:
        """Begin a piece of work of `total` steps.

        Those that an earlier run has done do not enter the remaining time.
        """
        self._current = self._bars.add_task(label, total=total, completed=done)

    def advance(self, steps: int = 1) -> None:
        """Report steps as done."""
        if self._current is None:
            raise RuntimeError("Progress.advance was called before Progress.start.")
        self._bars.advance(self._current, steps)
