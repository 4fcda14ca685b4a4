"""Settings of every benchmark."""

from dataclasses import dataclass


@dataclass(frozen=True)
class BenchSettings:
    """Settings of a benchmark.

    Examples
    --------
    >>> from labcal.pipeline import BenchSettings
    >>> BenchSettings(quick=True, methods=("hybrid",)).groups
    ()
    """

    quick: bool = False
    """Fewer and shorter measurements; each benchmark defines which."""
    seed: int = 0
    force: bool = False
    """Replace results that are there already."""
    groups: tuple[str, ...] = ()
    """Only these groups of checks, of a benchmark that has them; all where empty."""
    methods: tuple[str, ...] = ()
    """Methods to measure besides, of a benchmark of methods: names, or ``package.module:Class``."""
    scheduler: str | None = None
    """Of a Dask cluster that does the cases of a benchmark that has many: an address, or ``"local"``."""
    plan: str | None = None
    """Of the benchmark of distortion: ``quick``, ``full``, or the path of a YAML file."""
    overrides: tuple[str, ...] = ()
    """Of the benchmark of distortion: levels in the place of the plan's, each ``factor=level,level``."""
    seeds: int | None = None
    """Of the benchmark of distortion: number of seeds in the place of the plan's."""
