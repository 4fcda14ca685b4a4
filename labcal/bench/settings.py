"""Settings of every benchmark."""

from collections.abc import Sequence
from dataclasses import dataclass

from labcal.arguments import one_text, path_texts, set_checked, texts, truth_value, whole_number
from labcal.paths import AnyPath, as_text


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
    plan: AnyPath | None = None
    """Of the benchmark of distortion: ``quick``, ``full``, or the path of a YAML file."""
    overrides: Sequence[str] = ()
    """Of the benchmark of distortion: levels in the place of the plan's, each ``factor=level,level``."""
    seeds: int | None = None
    """Of the benchmark of distortion: number of seeds in the place of the plan's."""
    rendered: bool = False
    """Of the benchmark of distortion: measure cases through rendered pictures, too."""

    detections: Sequence[AnyPath] = ()
    """Of the benchmark of distortion: folders of shoots on a stage, or tables of their dots."""
    yes: bool = False
    """Of the benchmark of distortion: begin work that takes more than four hours on this machine."""

    def __post_init__(self) -> None:
        """Check the settings.

        Raises
        ------
        InputError, InputTypeError
            One is of a wrong type, or a number is too small.
        """
        values = {
            "quick": truth_value(self.quick, "quick"),
            "seed": whole_number(self.seed, "seed", 0),
            "force": truth_value(self.force, "force"),
            "groups": texts(self.groups, "groups"),
            "methods": texts(self.methods, "methods"),
            "scheduler": None if self.scheduler is None else one_text(self.scheduler, "scheduler"),
            "plan": None if self.plan is None else as_text(self.plan),
            "overrides": texts(self.overrides, "overrides"),
            "detections": path_texts(self.detections, "detections"),
            "seeds": None if self.seeds is None else whole_number(self.seeds, "seeds", 1),
            "yes": truth_value(self.yes, "yes"),
            "rendered": truth_value(self.rendered, "rendered"),
        }
        set_checked(self, values)
