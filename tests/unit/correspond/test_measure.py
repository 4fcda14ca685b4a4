import os
import signal
import sys
from dataclasses import dataclass

import numpy as np
import pytest

from labcal.correspond.measure import measure_pictures
from labcal.correspond.sources import Source
from labcal.run.executor import open_executor
from labcal.targets.grid import DotGrid


class Counted:
    def __init__(self) -> None:
        self.label, self.total, self.done = "", 0, 0

    def start(self, label: str, total: int, done: int = 0) -> None:
        self.label, self.total, self.done = label, total, done

    def advance(self, steps: int = 1) -> None:
        self.done += steps


@dataclass(frozen=True)
class CrashingSource(Source):
    """A picture that makes the library that decodes it crash."""

    def read(self) -> np.ndarray:
        os.kill(os.getpid(), signal.SIGSEGV)
        raise AssertionError("not reached")


@pytest.mark.skipif(sys.platform == "win32", reason="no signals there")
def test_a_picture_that_crashes_its_process_is_refused_and_the_others_are_measured(
    grid: DotGrid, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr("labcal.run.pool.TRIES_WITH_OTHERS", 1)  # fewer processes to wait for
    lost = [Source(f"v{number}", "left", f"lost-{number}.png", None) for number in range(3)]
    sources = [lost[0], CrashingSource("bad", "left", "bad.png", None), *lost[1:]]
    counted = Counted()
    with open_executor(2) as executor:
        found = measure_pictures(sources, grid, executor, counted)
    assert [measurement.source for measurement in found] == sources
    reason = found[1].reason or ""
    assert reason.startswith("The picture bad.png ended each process that measured it")
    assert "crashed with SIGSEGV" in reason
    assert "Leave it out" in reason
    with open_executor(1) as executor:
        alone = measure_pictures(lost, grid, executor, Counted())
    assert [found[0], *found[2:]] == alone
    assert (counted.total, counted.done) == (4, 4)
