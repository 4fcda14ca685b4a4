"""The command line in this process, and small shoots that several tests read and none may change."""

import contextlib
import io
import json
from collections.abc import Callable
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import pytest

from labcal.cli import main


@dataclass(frozen=True)
class Told:
    """What a command said."""

    status: int
    document: Any
    """The JSON document."""
    said: str
    """Everything on stderr."""


Run = Callable[..., Told]


def _run(*words: object) -> Told:
    """Run a command with --json; what it writes to stdout must be one document."""
    out, err = io.StringIO(), io.StringIO()
    with contextlib.redirect_stdout(out), contextlib.redirect_stderr(err):
        status = main([*map(str, words), "--json"])
    assert "Traceback" not in err.getvalue()
    return Told(status, json.loads(out.getvalue()), err.getvalue())


@pytest.fixture(scope="session")
def labcal() -> Run:
    """Return what runs a command."""
    return _run


@pytest.fixture(scope="session")
def stage(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """A rendered shoot of a target on a stage: one view to train on, one to test on."""
    folder = tmp_path_factory.mktemp("stage") / "shoot"
    options = ("--spp", 16, "--workers", 1, "--set", "photometry.bayer=off")
    assert _run("render", "webcam-plane", "-o", folder, *options).status == 0
    return folder


@pytest.fixture(scope="session")
def handheld(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """A rendered shoot of a target in the hand, three views."""
    folder = tmp_path_factory.mktemp("handheld") / "shoot"
    options = ("--views", 3, "--spp", 16, "--workers", 1)
    assert _run("render", "webcam-handheld", "-o", folder, *options).status == 0
    return folder


@pytest.fixture(scope="session")
def stage_dots(stage: Path, tmp_path_factory: pytest.TempPathFactory) -> Path:
    """The detections of the shoot on the stage."""
    path = tmp_path_factory.mktemp("stage-dots") / "detections.csv"
    assert _run("detect", stage, "-o", path, "--workers", 1).status == 0
    return path


@pytest.fixture(scope="session")
def handheld_dots(handheld: Path, tmp_path_factory: pytest.TempPathFactory) -> Path:
    """The detections of the hand-held shoot."""
    path = tmp_path_factory.mktemp("handheld-dots") / "detections.csv"
    assert _run("detect", handheld, "-o", path, "--workers", 1).status == 0
    return path
