"""`--scheduler`: a cluster that does the cases of a command, and what is refused."""

import sys
import time
from collections.abc import Callable
from pathlib import Path
from typing import Any

import pytest

from labcal.run import cluster

Run = Callable[..., Any]
NOBODY = "tcp://127.0.0.1:9"  # "discard", which nobody serves


@pytest.mark.parametrize(
    ("words", "status", "said"),
    [
        (("reproduce", "01", "--scheduler", "http://node:8786"), 2, "Did you mean 'tcp://node:8786'?"),
        (
            ("reproduce", "01", "--scheduler", NOBODY, "--workers", 3),
            2,
            "--workers is for processes of this mach",
        ),
        (("bench", "render", "--scheduler", NOBODY), 2, "--scheduler goes with 'bench solve'"),
        (("bench", "detect", "--scheduler", "local"), 2, "--scheduler goes with 'bench solve'"),
        (
            ("bench", "solve", "--only", "training,real", "--scheduler", "local"),
            2,
            "for the groups boards, certify, check",
        ),
        (("bench", "solve", "--scheduler", "somewhere"), 2, "'somewhere' is no address of a Dask scheduler"),
    ],
)
def test_what_cannot_be_is_refused_before_anything_is_made(
    words: tuple[object, ...], status: int, said: str, labcal: Run, tmp_path: Path
) -> None:
    found = labcal(*words, "-o", tmp_path / "out")
    assert found.status == status
    assert said in found.document["error"]["message"]
    assert list(tmp_path.iterdir()) == []


@pytest.mark.parametrize(
    "words",
    [("reproduce", "01"), ("bench", "solve", "--only", "limits"), ("bench", "distortion", "--quick")],
)
def test_a_scheduler_that_does_not_answer_is_named_before_anything_is_made(
    words: tuple[str, ...], labcal: Run, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(cluster, "ANSWER_S", 0.5)
    found = labcal(*words, "--scheduler", NOBODY, "-o", tmp_path / "out")
    assert found.status == 3
    assert f"No Dask scheduler answers at {NOBODY}" in found.document["error"]["message"]
    assert "'dask scheduler' starts one" in found.document["error"]["message"]
    assert list(tmp_path.iterdir()) == []


@pytest.mark.slow
def test_that_is_said_within_ten_seconds(labcal: Run, tmp_path: Path) -> None:
    assert labcal("reproduce", "01", "--scheduler", "nowhere", "-o", tmp_path / "out").status == 2  # imports
    began = time.monotonic()
    assert labcal("reproduce", "01", "--scheduler", NOBODY, "-o", tmp_path / "out").status == 3
    assert time.monotonic() - began < 10.0


def test_without_the_library_the_extra_is_named(
    labcal: Run, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setitem(sys.modules, "distributed", None)
    found = labcal("reproduce", "01", "--scheduler", "local", "-o", tmp_path / "out")
    assert found.status == 3
    assert "the library 'distributed'" in found.document["error"]["message"]
    assert "extra 'cluster'" in found.document["error"]["message"]


def without_seconds(tree: Any) -> Any:  # noqa: ANN401 - the trees of JSON have no type
    if isinstance(tree, dict):
        return {key: without_seconds(item) for key, item in tree.items() if not key.startswith("seconds")}
    return [without_seconds(item) for item in tree] if isinstance(tree, list) else tree


@pytest.mark.slow
def test_rows_of_the_paper_are_the_same_from_a_cluster(labcal: Run, tmp_path: Path) -> None:
    rows = ("reproduce", "01", "05", "--quick", "--seeds", 2)
    here = labcal(*rows, "--workers", 1, "-o", tmp_path / "here")
    there = labcal(*rows, "--scheduler", "local", "-o", tmp_path / "there")
    assert here.status == there.status == 0
    assert without_seconds(here.document) == without_seconds(there.document)
