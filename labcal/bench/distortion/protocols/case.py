"""A protocol with one seed, and the methods that are measured by it."""

from collections.abc import Mapping
from dataclasses import dataclass, field

from labcal.bench.distortion.case import Setting


@dataclass(frozen=True)
class ProtocolCase:
    """Work of one seed.

    Attributes
    ----------
    protocol : str
        Its name.
    seed : int
    methods : tuple of str
    settings : mapping
        Constructor arguments by method that differ from its defaults.
    sources : tuple of str
        Digests of the files of methods of one's own.
    """

    protocol: str
    seed: int
    methods: tuple[str, ...]
    settings: Mapping[str, Mapping[str, Setting]] = field(default_factory=dict)
    sources: tuple[str, ...] = ()

    @property
    def key(self) -> str:
        """The name of the result file."""
        return f"{self.protocol}_{self.seed}"
