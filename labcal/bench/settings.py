"""Settings of every benchmark."""

from collections.abc import Sequence
from dataclasses import dataclass

from labcal.arguments import one_text, set_checked, texts, truth_value, whole_number


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
    groups: Sequence[str] = ()
    """Only these groups of checks, of a benchmark that has them; all where empty."""
    methods: Sequence[str] = ()
    """Methods to measure besides, of a benchmark of methods: names, or ``package.module:Class``."""
    scheduler: str | None = None
    """Of a Dask cluster that does the cases of a benchmark that has many: an address, or ``"local"``."""

    def __post_init__(self) -> None:
        """Check the settings.

        Raises
        ------
        InputError, InputTypeError
            One is of a wrong type, or the seed is negative.
        """
        values = {
            "quick": truth_value(self.quick, "quick"),
            "seed": whole_number(self.seed, "seed", 0),
            "force": truth_value(self.force, "force"),
            "groups": texts(self.groups, "groups"),
            "methods": texts(self.methods, "methods"),
            "scheduler": None if self.scheduler is None else one_text(self.scheduler, "scheduler"),
        }
        set_checked(self, values)
