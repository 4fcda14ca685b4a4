"""The page: every section where the plan has something for it, chosen figures, and all numbers as files."""

import base64
import csv
import gzip
import io
import re
from collections.abc import Sequence
from pathlib import Path

import pytest
from made_up_distortion import REFUSES, made_up_findings

from labcal.bench.distortion.page.command import command_line
from labcal.bench.distortion.page.findings import Findings
from labcal.bench.distortion.page.page import distortion_page
from labcal.bench.distortion.page.plan_section import plan_section
from labcal.bench.distortion.plan import load_plan
from labcal.bench.settings import BenchSettings

FEW = (
    "families=brown,water",
    "strengths=0,0.5,1",
    "noise_px=0.02,0.05,0.1",
    "points=60,140,200",
    "faults=none",
)
ONE = ("families=water", "strengths=1", "noise_px=0.1", "points=140", "faults=none")


@pytest.fixture(scope="module")
def findings() -> Findings:
    return made_up_findings("quick", FEW, 2)


@pytest.fixture(scope="module")
def text(findings: Findings) -> str:
    return distortion_page(findings).text()


def headings(text: str) -> list[str]:
    return re.findall(r"<h2 id=[^>]*>([^<]*)</h2>", text)


def file_of(text: str, name: str) -> str:
    """Return the content of a file of the page."""
    packed = re.search(rf'<script type="application/gzip" id="file-{name}">([^<]*)</script>', text)
    assert packed is not None
    return gzip.decompress(base64.b64decode(packed[1])).decode()


def lines(text: str) -> Sequence[dict[str, str]]:
    return list(csv.DictReader(io.StringIO(text)))


def test_the_answer_stands_before_all_sections(findings: Findings, text: str) -> None:
    answer = findings.result.answer[0]
    assert answer.startswith("No: of 54 cells the best network has the smaller error in 0")
    assert text.index(answer) < text.index("<section")
    assert "mlp was measured with max_epochs 50." in text[: text.index("<section")]
    assert headings(text) == [
        "How far each method can be trusted",
        "Error as distortion grows",
        "Which method wins, and by how much",
        "Error as training points are added",
        "Can the stated uncertainty be believed?",
        "Outside the trained volume",
        "Checks",
        "The plan, and all files",
    ]


def test_sections_without_figures_are_left_out() -> None:
    few = ("methods=dlt,affine", "families=water", "points=60", "measured=within", "faults=none")
    page = distortion_page(made_up_findings("quick", few, 1)).text()
    assert "This run does not say" in page
    assert [one for one in headings(page) if "added" in one or "Outside" in one] == []
    assert "60 training points or more" in page


def test_methods_that_refuse_are_listed_with_their_reason() -> None:
    page = distortion_page(made_up_findings("quick", ("methods=dlt,quadratic", *ONE), 1)).text()
    table = page[page.index('id="reasons"') :]
    assert f'<th scope="row" class="text">{REFUSES}</th>' in table
    assert "InputError: too few points" in table
    nothing = distortion_page(made_up_findings("quick", ("methods=quadratic", *ONE), 1)).text()
    assert headings(nothing) == ["How far each method can be trusted", "Which method wins, and by how much",
                                 "Checks", "The plan, and all files"]  # fmt: skip


def test_figures_are_of_chosen_levels_and_hand_out_their_numbers(text: str) -> None:
    drawn = re.findall(r'<figure class="chart" id="([^"]*)"', text)
    kinds = ("error", "learning", "coverage", "outside")
    assert drawn == [f"{kind}-{family}" for kind in kinds for family in ("brown", "water")]
    error = lines(file_of(text, "error-water-csv"))
    assert {line["points"] for line in error} == {"140"}
    assert {line["noise_px"] for line in error} == {"0.02", "0.1"}
    assert {line["measured"] for line in error} == {"within"}
    assert len(error) == 5 * 3 * 2
    assert {line["measured"] for line in lines(file_of(text, "outside-water-csv"))} == {"outside"}


def test_all_cells_the_plan_and_the_checks_are_files_of_the_page(findings: Findings, text: str) -> None:
    cells = lines(file_of(text, "cells-csv"))
    assert len(cells) == len(findings.summaries) == 5 * 54 * 2
    first, one = cells[0], findings.summaries[0]
    assert (float(first["over_oracle"]), float(first["low"])) == (one.over_oracle, one.low)
    assert findings.result.plan_sha256 in text
    assert '"checks"' in file_of(text, "results-json")


def test_the_plan_of_the_page_is_the_plan(findings: Findings, text: str, tmp_path: Path) -> None:
    (tmp_path / "plan.yaml").write_text(file_of(text, "plan-yaml"), encoding="utf-8")
    assert load_plan(str(tmp_path / "plan.yaml")).sha256 == findings.result.plan_sha256


def test_results_that_are_too_long_stand_beside_the_page_alone(
    findings: Findings, monkeypatch: pytest.MonkeyPatch
) -> None:
    long = Findings(findings.result, findings.summaries, "a,b\n1,2\n")

    def held() -> list[str]:
        return [asset.name for part in plan_section(long).parts for asset in part.assets]

    assert held()[-1] == "file-results-csv"
    monkeypatch.setattr("labcal.bench.distortion.page.plan_section._MOST_BYTES", 7)
    assert "file-results-csv" not in held()


def test_the_same_findings_give_the_same_page() -> None:
    few = ("families=water", "points=140", "noise_px=0.1", "measured=within", "faults=none")
    one, other = (distortion_page(made_up_findings("quick", few, 2)).text() for _ in range(2))
    assert one == other


def test_the_command_of_the_page_measures_the_same_plan() -> None:
    settings = BenchSettings(
        quick=True, seed=7, methods=("affine",), overrides=("strengths=0,1", "families=water"), seeds=2,
        scheduler="local", force=True,
    )  # fmt: skip
    command = command_line(settings)
    assert command == (
        "labcal bench distortion --quick --set strengths=0,1 --set families=water --method affine --seeds 2 "
        "--seed 7 -o DIR"
    )
    assert "'my plan.yaml'" in command_line(BenchSettings(plan="my plan.yaml"))


@pytest.mark.slow
def test_the_page_of_the_full_plan_stays_below_ten_megabytes() -> None:
    assert len(distortion_page(made_up_findings("full")).text()) < 10_000_000
