"""The exit status of a command."""

from enum import IntEnum


class ExitStatus(IntEnum):
    """Exit status of a command."""

    DONE = 0
    PARTIAL = 1
    """Done in part; the JSON states what is missing and why."""
    UNUSABLE = 2
    """Wrong use, or nothing usable given."""
    FAILED = 3
    """A device or the program itself failed."""
    INTERRUPTED = 130
    """Ctrl-C (128 + SIGINT)."""
    NOBODY_READS = 141
    """The reader of stdout went away (128 + SIGPIPE)."""
    TERMINATED = 143
    """128 + SIGTERM."""
