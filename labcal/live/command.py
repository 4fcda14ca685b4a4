"""Wishes that a person can have on the live page."""

from dataclasses import dataclass
from enum import StrEnum


class Command(StrEnum):
    """A button of the live page, by the word that it sends."""

    TAKE = "take"
    """Take the next view now."""
    AUTO = "auto"
    """Take each view by itself, as soon as the target is found and held still."""
    BY_HAND = "by-hand"
    """Take a view only when asked."""
    FINISH = "finish"
    """Take no more; calibrate."""
    DROP = "drop"
    """Take a view out of the shoot again; the view is named, so that two presses do not drop two."""
    CLOSE = "close"
    """Stop serving the page."""


@dataclass(frozen=True)
class Wish:
    """A wish that the page has sent."""

    command: Command
    view: str = ""
    """Name of the view that it is about; empty for all commands but ``drop``."""
