import json
from pathlib import Path

import pytest

from labcal.cli import main
from labcal.targets.catalogue import load_target

WORDS = ["target", "make", "--size", "640x480", "--fov", "60", "--distance", "350,400", "--tilt", "30"]


def test_make_writes_what_every_command_takes(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    board, sheet = tmp_path / "board.yaml", tmp_path / "board.pdf"
    words = [*WORDS, "--name", "mine", "-o", str(board), "--print", str(sheet), "--json"]
    assert main(words) == 0
    told = json.loads(capsys.readouterr().out)
    target = load_target(board)
    assert told["target"] == target.name == "mine"
    assert told["description"] == target.model_dump(mode="json")
    assert told["dots"] == target.count
    assert told["least_px"] >= told["needed_px"]
    assert len(told["views"]) == 4
    assert all(view["sigma_px"] <= told["sigma_px"] for view in told["views"])
    assert {"target", "fits", "reasons", "relative_error", "paper"} == told["shipped"][0].keys()
    assert sheet.read_bytes().startswith(b"%PDF")
    first = board.read_bytes(), sheet.read_bytes()
    assert main(words) == 2
    assert main([*words, "--force"]) == 0
    assert (board.read_bytes(), sheet.read_bytes()) == first
    capsys.readouterr()
    assert main(["target", "export", str(board), "-o", str(tmp_path / "again.pdf")]) == 0


def test_make_only_tells_without_an_output(capsys: pytest.CaptureFixture[str]) -> None:
    assert main(WORDS) == 0
    out = capsys.readouterr().out
    assert "Shipped targets:" in out
    assert "Design a4-" in out


@pytest.mark.parametrize(
    ("words", "said"),
    [
        (["--distance", "400"], "--size"),
        (["--size", "640x480", "--distance", "400"], "--fov"),
        (["--size", "640", "--fov", "60", "--distance", "400"], "1280x960"),
        (["--size", "640x480", "--fov", "60"], "--distance"),
        (["--size", "640x480", "--fov", "60", "--focal-px", "500", "--distance", "400"], "given once"),
        (["--rig", "webcams", "--size", "640x480"], "--rig"),
        (["--rig", "webcamz"], "webcams"),
        ([*WORDS[2:], "--paper", "b4"], "a4"),
        ([*WORDS[2:], "--kind", "chess"], "charuco"),
        ([*WORDS[2:], "--sensor", "webcam"], "webcam-2000"),
        ([*WORDS[2:], "-o", "board.json"], ".yaml"),
        ([*WORDS[2:], "--print", "board.png"], ".pdf"),
        ([*WORDS[2:], "--volume", "300"], "300,200"),
    ],
)
def test_make_refuses_in_words_that_mend(
    words: list[str],
    said: str,
    capsys: pytest.CaptureFixture[str],
    monkeypatch: pytest.MonkeyPatch,
    tmp_path: Path,
) -> None:
    monkeypatch.chdir(tmp_path)
    assert main(["target", "make", *words, "--json"]) == 2
    assert said in json.loads(capsys.readouterr().out)["error"]["message"]
    assert list(tmp_path.iterdir()) == []


def test_export_tells_the_paper_and_writes_tiles(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    whole, pages = str(tmp_path / "whole.pdf"), str(tmp_path / "pages.pdf")
    assert main(["target", "export", "plain-11x8", "-o", whole, "--json"]) == 0
    out, err = capsys.readouterr()
    told = json.loads(out)
    assert (told["paper"], told["fits_a4"], told["pages"]) == ("a3", False, 1)
    assert "does not fit on A4" in err
    assert "--paper" in err
    assert main(["target", "export", "plain-11x8", "-o", pages, "--paper", "a4", "--json"]) == 0
    out, err = capsys.readouterr()
    told = json.loads(out)
    assert (told["paper"], told["pages"], told["tiles"]) == ("a4", 2, [2, 1])
    assert err == ""
    assert main(["target", "export", "rings-10x8", "-o", str(tmp_path / "r.pdf"), "--json"]) == 0
    out, err = capsys.readouterr()
    assert json.loads(out)["fits_a4"]
    assert err == ""


@pytest.mark.parametrize(
    ("words", "said"),
    [
        (["--paper", "a4", "--tiles", "1x1"], "does not fit"),
        (["--tiles", "2x2"], "--paper"),
        (["--paper", "a4", "--dpi", "300"], "--dpi"),
    ],
)
def test_export_refuses_by_name(
    words: list[str], said: str, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    assert main(["target", "export", "plain-11x8", "-o", str(tmp_path / "x.pdf"), *words, "--json"]) == 2
    assert said in json.loads(capsys.readouterr().out)["error"]["message"]
    assert list(tmp_path.iterdir()) == []


def test_list_and_show_tell_the_smallest_paper(capsys: pytest.CaptureFixture[str]) -> None:
    assert main(["target", "list", "--json"]) == 0
    papers = json.loads(capsys.readouterr().out)["papers"]
    assert papers["webcam-a4"] == papers["machine-a4"] == "a4"
    assert papers["charuco-12x9"] == "a3"
    assert main(["target", "show", "charuco-12x9"]) == 0
    assert "smallest paper" in capsys.readouterr().out
