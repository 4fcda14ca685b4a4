"""``labcal compare`` and ``labcal certify``: the pages of Python's, documents, status and messages."""

import json
from pathlib import Path

import pytest

import labcal
from labcal import LengthPlan, ReferenceLengths, examples, plan_lengths
from labcal.cli import main
from labcal.cli.option_words import in_options
from labcal.pipeline import CertifySettings, CompareSettings, PageOutput


@pytest.fixture(autouse=True)
def files(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.chdir(tmp_path)
    examples.rig().save("rig.json")
    examples.pixels().save("pixels.csv")
    examples.lengths().save("lengths.csv")


COMPARE = ("compare", "rig.json", "rig.json", "--distances-mm", "600,500", "--pictures", "different")
CERTIFY = ("certify", "rig.json", "pixels.csv", "--lengths", "lengths.csv", "--date", "2026-11-26")


def test_compare_makes_the_page_of_python() -> None:
    assert main([*COMPARE, "-o", "command.html"]) == 0
    settings = CompareSettings(distances_mm=(600.0, 500.0), pictures="different")
    # The page names the command that makes it.
    command = "labcal compare rig.json rig.json --distances-mm 600,500 --pictures different -o command.html"
    page = PageOutput("python.html", command=command, phrase=in_options, inputs=("rig.json", "rig.json"))
    labcal.compare("rig.json", "rig.json", settings, page=page)
    assert Path("command.html").read_bytes() == Path("python.html").read_bytes()
    text = Path("command.html").read_text(encoding="utf-8")
    assert "left: difference at 500 mm." in text
    assert "right: difference at infinity." in text


def test_the_document_of_a_comparison(capfd: pytest.CaptureFixture[str]) -> None:
    assert main([*COMPARE, "--json"]) == 0
    document = json.loads(capfd.readouterr().out)
    assert [part["distance_mm"] for part in document["cameras"]["left"]["differences"]] == [
        500.0,
        600.0,
        None,
    ]
    assert document["cameras"]["left"]["differences"][0]["expected_a_px"] is None
    assert document["volume"]["rms_mm"] < 1e-6
    assert document["volume"]["T_a_b"][0][:3] == pytest.approx([1.0, 0.0, 0.0], abs=1e-9)
    assert document["consistent"] is None
    assert document["pictures"] == "different"


def test_without_a_volume_a_comparison_is_done_in_part(capfd: pytest.CaptureFixture[str]) -> None:
    assert main(["compare", "rig.json", "rig.json"]) == 1
    told = capfd.readouterr()
    assert "give --distances-mm" in told.err
    assert "the calibrations are the same" in told.out.lower()
    assert all(len(line) <= 80 for line in told.out.splitlines() if "│" in line)
    labcal.Rig.of({"only": examples.rig().camera("left")}).save("only.json")
    assert main(["compare", "only.json", "only.json"]) == 0


def test_certify_makes_the_certificate_of_python() -> None:
    words = ["--operator", "M. Muster", "--volume-mm", "100,90,70", "--limit-mm", "0.5", "-o", "command.html"]
    assert main([*CERTIFY, *words]) == 1
    command = "labcal " + " ".join(CERTIFY) + " --operator 'M. Muster' " + " ".join(words[2:])
    settings = CertifySettings(
        limit_mm=0.5, operator="M. Muster", volume_mm=(100.0, 90.0, 70.0), date="2026-11-26"
    )
    page = PageOutput(
        "python.html", command=command, phrase=in_options, inputs=("pixels.csv", "lengths.csv", "rig.json")
    )
    found = labcal.certify("pixels.csv", "lengths.csv", settings, rig=Path("rig.json"), page=page)
    assert Path("command.html").read_bytes() == Path("python.html").read_bytes()
    text = Path("command.html").read_text(encoding="utf-8")
    assert "The test is incomplete" in text
    assert "rig.json, SHA-256 " in text
    assert "size: A4 portrait" in text
    assert "`" not in found.warnings[0] or "--plan" in text


def test_status_tells_the_outcome(capfd: pytest.CaptureFixture[str]) -> None:
    assert main([*CERTIFY]) == 0  # no limit: measured, and nothing decided
    assert main([*CERTIFY, "--limit-mm", "0.01"]) == 1
    told = capfd.readouterr()
    assert "Non-conformity is proven" in told.out
    assert all(len(line) <= 80 for line in told.out.splitlines() if "│" in line)
    assert main([*CERTIFY, "--limit-mm", "0.01", "--json"]) == 1
    document = json.loads(capfd.readouterr().out)
    assert document["outcome"] == "not-conforming"
    assert document["n"] == 3
    assert document["lengths"][0]["calibration_sigma_mm"] is None
    assert document["rule"] == "iso-14253-1"


def test_a_plan_is_a_form_that_python_makes_too(capfd: pytest.CaptureFixture[str]) -> None:
    assert main(["certify", "--plan", "--volume-mm", "400,300,200", "-o", "form.csv", "--json"]) == 0
    plan: LengthPlan = plan_lengths((400, 300, 200))
    plan.save("python.csv")
    assert Path("form.csv").read_bytes() == Path("python.csv").read_bytes()
    document = json.loads(capfd.readouterr().out)
    assert len(document["lengths"]) == 35
    assert document["lengths"][0]["a_mm"] == [-200.0, -150.0, -100.0]
    assert ReferenceLengths.load("form.csv") == plan.lengths()


@pytest.mark.parametrize(
    ("words", "message"),
    [
        (["compare", "rig.json", "rig.json", "--cameras", "left"], "--cameras pairs each name"),
        (["compare", "rig.json", "rig.json", "--distances-mm", "1,x"], "--distances-mm takes numbers"),
        (["compare", "rig.json", "pixels.csv"], "pixels.csv"),
        (["compare", "rig.json", "rig.json", "--force"], "--force"),
        (["certify", "--plan", "-o", "x.csv"], "--volume-mm"),
        (["certify", "--plan", "--volume-mm", "1,2", "-o", "x.csv"], "--volume-mm"),
        (
            ["certify", "rig.json", "--plan", "--volume-mm", "1,2,3", "-o", "x.csv"],
            "goes with a test",
        ),
        (["certify", "--plan", "--volume-mm", "1,2,3", "--limit-mm", "1", "-o", "x.csv"], "--limit-mm"),
        (["certify", "rig.json", "pixels.csv"], "--lengths"),
        (["certify", "pixels.csv", "--lengths", "lengths.csv"], "Give --rig"),
        (["certify", "rig.json", "--lengths", "lengths.csv"], "rig.json"),
        ([*CERTIFY, "--rig", "rig.json"], "--rig"),
        ([*CERTIFY, "--longest-mm", "3"], "--longest-mm"),
        ([*CERTIFY, "--limit-mm", "0"], "both 0"),
        ([*CERTIFY, "-o", "page.txt"], ".html"),
    ],
)
def test_wrong_use_is_refused_with_advice(
    words: list[str], message: str, capfd: pytest.CaptureFixture[str]
) -> None:
    assert main(words) == 2
    assert message in capfd.readouterr().err
