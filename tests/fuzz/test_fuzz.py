import os
import warnings
from collections.abc import Iterator
from pathlib import Path

import pytest

from fuzz.campaign import judged, mutants, run
from fuzz.jobs import JOBS
from fuzz.judge import faults_of_ending, faults_of_output
from fuzz.mutators import Mutant
from fuzz.seeds import make_seeds
from labcal.cli import main

FEW, MANY = 150, 2000
SLOW = {"detect", "inspect", "calibrate", "undistort"}
"""Commands of which a mutant takes more than some hundredths of a second."""


@pytest.fixture(scope="module")
def seeds(tmp_path_factory: pytest.TempPathFactory) -> Path:
    return make_seeds(tmp_path_factory.mktemp("fuzz") / "seeds")


@pytest.fixture
def _here() -> Iterator[None]:
    """Come back from the folder that a mutant was read in."""
    before = Path.cwd()
    with warnings.catch_warnings():
        warnings.simplefilter("always")  # to stderr, which the judge reads
        yield
    os.chdir(before)


@pytest.mark.slow
@pytest.mark.usefixtures("_here")
def test_seeds_are_read_by_the_commands_that_their_mutants_are_given_to(seeds: Path, tmp_path: Path) -> None:
    """Else every mutant would be refused for another reason than its own."""
    refused = {"key", "size", "mark", "value", "manifest to detect", "tone curve"}  # no pictures, no key
    for job in JOBS:
        if job.name in refused or job.name.startswith("picture") or "export" in job.name:
            continue
        mutant = Mutant((seeds / job.file).read_bytes(), "nothing")
        status, _, _, faults = judged(main, job, mutant, seeds, tmp_path)
        assert (status, faults) == (0, []), job.name


@pytest.mark.usefixtures("_here")
def test_mutants_are_read_or_refused_with_a_reason(seeds: Path, tmp_path: Path) -> None:
    statuses = set()
    for number, job, mutant in mutants(seeds, 14, FEW):
        if job.argv[0] in SLOW or "check" in job.argv:
            continue
        status, _, _, faults = judged(main, job, mutant, seeds, tmp_path)
        assert not faults, f"mutant {number}: {job.name} [{mutant.what}]"
        statuses.add(status)
    assert {0, 2} <= statuses


@pytest.mark.slow
def test_many_mutants_within_their_time_and_memory(seeds: Path, tmp_path: Path) -> None:
    found = [outcome for outcome in run(seeds, tmp_path / "home", 15, MANY) if outcome.faults]
    assert not found


def test_the_judge_sees_what_a_careful_reader_would_refuse(seeds: Path, tmp_path: Path) -> None:
    assert faults_of_ending(3, "x", "{}")
    assert faults_of_ending(2, "", "{}")
    assert faults_of_ending(0, "\x1b[2J", "{}")
    assert faults_of_ending(0, "RuntimeWarning: overflow", "{}")
    assert faults_of_ending(0, "", '{"a": NaN}')
    assert faults_of_ending(0, "", '{"a": 1e999}')
    assert not faults_of_ending(2, "error: no.", '{"error": 1}')
    rig = (seeds / "rig.json").read_text()
    path = tmp_path / "out.json"
    for old, new in (
        ("900.0", "-900.0"),
        ("900.0", "2147483648.0"),
        ("640", "0"),
        ("-0.1", "1e30"),
        ("900.0", "NaN"),
    ):
        path.write_text(rig.replace(old, new, 1))
        assert faults_of_output(path, "{}", "out.json"), new
    points = (seeds / "points.csv").read_text().splitlines()
    table = tmp_path / "out.csv"
    for lines in ([*points, points[1]], [points[0], points[1].replace(points[1].split(",")[5], "1e200")]):
        table.write_text("\n".join(lines) + "\n")
        assert faults_of_output(table, "{}", "out.csv")
