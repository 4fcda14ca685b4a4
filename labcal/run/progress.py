"""How long work tells that it goes on: an interface that the command line fills in."""

from typing import Protocol, runtime_checkable


@runtime_checkable  # so that tests can check annotations
class Progress(Protocol):
    """Receives how far a piece of work has come."""

    def start(self, label: str, total: int) -> None:
        """Begin a piece of work of `total` steps."""

    def advance(self, steps: int = 1) -> None:
        """Report steps as done."""


class NoProgress:
    """Nobody is watching."""

    def start(self, label: str, total: int) -> None:
        """Do nothing."""

    def advance(self, steps: int = 1) -> None:
        """Do nothing."""
