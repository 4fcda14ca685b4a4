"""What a group of checks is told, and what it answers."""

from dataclasses import dataclass
from pathlib import Path

from labcal.report.bench import Check, Figure
from labcal.run.progress import Progress


@dataclass(frozen=True)
class Bench:
    """What every group of checks is told."""

    quick: bool
    seed: int
    folder: Path
    """For what a group leaves beside its figures."""
    progress: Progress


@dataclass(frozen=True)
class Findings:
    """The figures of one group."""

    checks: list[Check]
    beside: list[Figure]
    """For comparison; without a limit."""
    notes: tuple[str, ...] = ()
    """What was left out, and why."""
