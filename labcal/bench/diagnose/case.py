"""One diagnosed shoot of the benchmark."""

from dataclasses import dataclass
from pathlib import Path
from tempfile import TemporaryDirectory

from pydantic import BaseModel, ConfigDict

from labcal.bench.diagnose.held_shoot import PAIRS, TARGETS
from labcal.bench.diagnose.mistaken import drawn_evidence, evidence_of
from labcal.guide.diagnosis.check_name import CheckName
from labcal.guide.diagnosis.diagnosing import diagnosed
from labcal.rng import generator

_SYMMETRIC = {CheckName.TURNED_TARGET}
"""Mistakes that only a target without rings lets happen."""
_HARMLESS = {(CheckName.POOR_COVERAGE, "narrow"): "wide"}
"""Mistakes that harm no measurement with a pair at any size, and the pair that they are made with instead."""


@dataclass(frozen=True)
class DiagnosedShoot:
    """A case: mistakes with the levels of their sizes, and a seed; none of a good shoot.

    Attributes
    ----------
    mistakes : tuple of (str, int)
        Names of checks, and levels.
    seed : int
    drawn : bool
        True for a good shoot with pictures.
    """

    mistakes: tuple[tuple[str, int], ...]
    seed: int
    drawn: bool = False

    @property
    def key(self) -> str:
        """The name of the result file."""
        names = "-and-".join(f"{name}-{level}" for name, level in self.mistakes) or "good"
        return f"{names}{'-drawn' if self.drawn else ''}-{self.seed}"

    @property
    def rig(self) -> tuple[str, str]:
        """Kind of the pair, and layout of the target, which the seed determines."""
        kinds = tuple(PAIRS)
        layout = TARGETS[self.seed // len(kinds) % len(TARGETS)]
        plain = any(CheckName(name) in _SYMMETRIC for name, _ in self.mistakes)
        kind = kinds[self.seed % len(kinds)]
        for name, _ in self.mistakes:
            kind = _HARMLESS.get((CheckName(name), kind), kind)
        return kind, TARGETS[1] if plain else layout


class DiagnosedFigures(BaseModel):
    """The diagnosis of one shoot, in short."""

    model_config = ConfigDict(frozen=True, extra="forbid")

    named: tuple[str, ...]
    """Checks with findings, the most harmful first, each once."""
    explained: tuple[str, ...]
    harms_percent: tuple[float | None, ...]
    """Of `named`; null where it is not known or infinite."""


def diagnosed_shoot(case: DiagnosedShoot) -> DiagnosedFigures:
    """Make the shoot, and return the names of what is found."""
    mistakes = [(CheckName(name), level) for name, level in case.mistakes]
    random = generator(case.seed, "bench solve", "diagnose", case.key)
    with TemporaryDirectory(prefix="labcal-diagnose-") as home:
        if case.drawn:
            evidence = drawn_evidence(case.rig, Path(home), random)
        else:
            evidence = evidence_of(mistakes, case.rig, Path(home), random)
        found = diagnosed(evidence)
    first: dict[str, float | None] = {}
    for one in found.findings:
        first.setdefault(one.check.value, one.harm_percent)
    known = tuple(None if harm is None or harm == float("inf") else harm for harm in first.values())
    return DiagnosedFigures(
        named=tuple(first), explained=tuple(one.check.value for one in found.explained), harms_percent=known
    )
