"""What every benchmark is told."""

from dataclasses import dataclass


@dataclass(frozen=True)
class BenchSettings:
    """How a benchmark runs."""

    quick: bool = False
    """Less of everything that takes long; the benchmark's own file says what."""
    seed: int = 0
    force: bool = False
    """Replace results that are there already."""
    groups: tuple[str, ...] = ()
    """Only these groups of checks, of a benchmark that has them; all where empty."""
    methods: tuple[str, ...] = ()
    """Methods to measure besides, of a benchmark of methods: names, or ``package.module:Class``."""
