"""Wishes that a person can have on the live page."""

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
    CLOSE = "close"
    """Stop serving the page."""
