import os
import signal
from pathlib import Path

import numpy as np
import pytest

from labcal.bench.detect import hostile_files
from labcal.bench.detect.hostile_encoding import TARGET, dots_picture, encoded
from labcal.bench.detect.hostile_files import KINDS, hostile_file
from labcal.bench.detect.limited_process import LimitedProcess, Limits
from labcal.correspond.measure import measure_picture
from labcal.correspond.sources import Source

NOISE = list(KINDS).index("noise")
NO_TARGET = {"tiny", "empty scene", "noise", "bomb", "size patched", "no file"}
"""Kinds in which there are no dots to be found, whatever the seed."""


@pytest.fixture(autouse=True)
def small_bombs(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(hostile_files, "BOMBS", ((9_000, 9_000),))
    monkeypatch.setattr(hostile_files, "STUFFED", ((500, 500),))


def test_inputs_follow_from_the_seed(tmp_path: Path) -> None:
    for home in ("a", "b"):
        (tmp_path / home).mkdir()
    for number in range(len(KINDS)):
        one, two = (hostile_file(number, 5, tmp_path / home) for home in ("a", "b"))
        assert one.name == two.name
        assert one.is_file() == two.is_file() == ("no file" not in one.name)
        if one.is_file():
            assert one.read_bytes() == two.read_bytes()
    other = hostile_file(NOISE, 6, tmp_path)
    assert other.read_bytes() != hostile_file(NOISE, 5, tmp_path / "a").read_bytes()


def test_each_kind_gives_a_result_or_a_reason(tmp_path: Path) -> None:
    for number in range(3 * len(KINDS)):
        path = hostile_file(number, 1, tmp_path)
        found = measure_picture(Source("view", "camera", str(path), None), TARGET)
        kind = path.stem.partition("-")[2]
        if kind == "whole":
            assert found.indexed, path
        elif kind in NO_TARGET:
            assert not found.indexed, path
            assert (found.reason or "").endswith("."), found.reason  # a sentence


def test_values_that_are_no_picture_are_a_reason(tmp_path: Path) -> None:
    for name, values in (
        ("whole", np.zeros((40, 40), np.int32)),
        ("nan", np.full((40, 40), np.nan, np.float32)),
    ):
        path = tmp_path / f"{name}.tif"
        path.write_bytes(encoded(values, ".tif"))
        assert measure_picture(Source("view", "camera", str(path), None), TARGET).reason is not None


def test_a_watched_process_is_replaced_when_it_hangs_or_dies(tmp_path: Path) -> None:
    path = tmp_path / "a.png"
    path.write_bytes(encoded(np.zeros((40, 40), np.uint8), ".png"))
    with LimitedProcess(TARGET, dots_picture(), Limits(2**30, 60.0)) as process:
        assert process.measure(path).ending == "reason"
        assert process._process is not None
        assert process._process.pid is not None
        os.kill(process._process.pid, signal.SIGSTOP)
        process.limits = Limits(2**30, 0.5)
        assert process.measure(path).ending == "hang"
        process.limits = Limits(2**30, 60.0)
        assert process.measure(path).ending == "reason"
        assert process._process is not None
        process._process.kill()
        assert process.measure(path).ending == "crash"
