"""Cases whose result shows the number of threads in its last digits, and that note when they begin."""

import os
import time
from dataclasses import dataclass, field
from pathlib import Path

import numpy as np
from pydantic import BaseModel, ConfigDict

from labcal.run.case import CaseOutcome
from labcal.run.json_text import to_json


@dataclass(frozen=True)
class Sum:
    """A sum over random numbers."""

    seed: int
    notes: Path | None = field(default=None, compare=False)
    """Where to note that it begins."""
    pause_s: float = field(default=0.0, compare=False)
    ends_process: bool = False

    @property
    def key(self) -> str:
        return f"sum-{self.seed}"


class Figures(BaseModel):
    model_config = ConfigDict(frozen=True, extra="forbid")
    norm: float
    product: float


def summed(case: Sum) -> Figures:
    if case.notes is not None:
        (case.notes / f"{case.key}--{os.getpid()}-{time.monotonic_ns()}").touch()
    if case.ends_process:
        os._exit(9)
    random = np.random.default_rng(case.seed)
    A = random.standard_normal((160, 160))
    time.sleep(case.pause_s)
    return Figures(norm=float(np.linalg.norm(A @ A.T @ A)), product=float(np.linalg.slogdet(A)[1]))


def sums(count: int, notes: Path | None = None, pause_s: float = 0.0) -> list[Sum]:
    return [Sum(seed, notes, pause_s) for seed in range(count)]


def document(outcomes: list[CaseOutcome[Figures]]) -> str:
    """Return the results, each with its name, as a benchmark would write them."""
    assert [one.reason for one in outcomes if one.result is None] == []
    return to_json({one.key: one.result for one in outcomes})


def begun(notes: Path) -> dict[str, int]:
    """Return how often each case was begun."""
    found: dict[str, int] = {}
    for path in notes.iterdir():
        key = path.name.partition("--")[0]
        found[key] = found.get(key, 0) + 1
    return found
