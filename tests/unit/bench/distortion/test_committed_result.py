"""The committed result of the documentation: of the plan that its page names, with all of its figures."""

import re
import shlex
from pathlib import Path

import pytest

from labcal.bench.distortion.requested_plan import plan_of
from labcal.bench.distortion.result import DistortionResult
from labcal.bench.settings import BenchSettings
from labcal.cli import build_parser
from labcal.run.documents import read_document

DOCS = Path(__file__).parents[4] / "docs"


@pytest.fixture(scope="module")
def committed() -> DistortionResult:
    return read_document(DistortionResult, "result file", DOCS / "results" / "distortion.json")


def test_it_is_of_the_command_that_the_page_names(committed: DistortionResult) -> None:
    """A change of the plan asks for a new run; a new run, for its command in the page."""
    page = (DOCS / "explanation" / "which-method.md").read_text(encoding="utf-8")
    command = re.search(r"^labcal (bench distortion .*)$", page, re.MULTILINE)
    assert command is not None
    given = build_parser("bench").parse_args(shlex.split(command[1]))
    plan = plan_of(
        BenchSettings(
            quick=given.quick,
            plan=given.plan,
            overrides=given.overrides,
            seeds=given.seeds,
            rendered=given.rendered,
        )
    )
    assert committed.plan_sha256 == plan.sha256 == committed.plan.sha256
    assert committed.plan == plan
    assert (committed.quick, committed.first_seed) == (given.quick, given.seed)


def test_it_has_figures_of_every_method_family_and_strength(committed: DistortionResult) -> None:
    plan = committed.plan
    every = {(f, m, s) for f in plan.families for m in plan.methods for s in plan.strengths}
    for figures in (committed.families, committed.outside):
        assert {(one.family, one.method, one.strength) for one in figures} == every
    assert len(committed.winners) == plan.cell_count * len(plan.measured)
    assert committed.cases == plan.case_count
    assert committed.answer
