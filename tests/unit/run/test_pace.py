"""The pace of this machine, with which durations are announced."""

import os
from collections.abc import Iterator

import pytest

from labcal.run import pace
from labcal.run.pace import core_pace, crowding


def test_programs_share_the_processors(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(os, "cpu_count", lambda: 4)
    monkeypatch.setattr(os, "getloadavg", lambda: (6.0, 2.0, 0.5))
    assert crowding(2, 60.0) == 2.0  # eight programs on four processors
    assert crowding(2, 600.0) == 1.0
    assert crowding(4, 600.0) == 1.5
    assert crowding(4, 3600.0) == 1.125


def test_a_system_that_reports_no_load_is_taken_for_idle(monkeypatch: pytest.MonkeyPatch) -> None:
    def none() -> tuple[float, float, float]:
        raise OSError

    monkeypatch.setattr(os, "getloadavg", none)
    assert crowding(2, 60.0) == 1.0
    monkeypatch.delattr(os, "getloadavg")
    assert crowding(2, 60.0) == 1.0


def test_the_fastest_try_counts_beside_that_of_the_reference(monkeypatch: pytest.MonkeyPatch) -> None:
    def times() -> Iterator[float]:
        now = 0.0
        for duration in (0.05, 0.0098, *(0.02,) * 20):
            yield now
            now += duration
            yield now

    clock = times()
    monkeypatch.setattr(pace.time, "process_time", lambda: next(clock))
    assert core_pace() == pytest.approx(2.0)


def test_the_real_one_is_a_pace() -> None:
    assert 0.05 < core_pace() < 50.0
