import json
from pathlib import Path

import pytest

from labcal.cli import main
from labcal.targets.catalogue import load_target, target_names


def test_list_names_every_target(capsys: pytest.CaptureFixture[str]) -> None:
    assert main(["target", "list", "--json"]) == 0
    told = json.loads(capsys.readouterr().out)
    assert [entry["name"] for entry in told["targets"]] == target_names()
    assert told["kinds"] == ["dots", "charuco", "coded-dots", "chessboard", "aprilgrid", "boards"]
    assert main(["target", "list"]) == 0
    table = capsys.readouterr().out
    assert all(
        name in table
        for name in (*target_names(), "dots, charuco, coded-dots, chessboard, aprilgrid, boards")
    )


def test_show_gives_the_description_itself(capsys: pytest.CaptureFixture[str]) -> None:
    assert main(["target", "show", "paper-13x10", "--json"]) == 0
    shown = json.loads(capsys.readouterr().out)
    assert type(load_target("paper-13x10")).model_validate(shown) == load_target("paper-13x10")
    assert main(["target", "show", "paper-13x10"]) == 0
    assert "77.777" in capsys.readouterr().out


@pytest.mark.parametrize("ending", ["svg", "pdf", "png"])
def test_export_writes_once_and_again_with_force(
    ending: str, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    path = tmp_path / f"target.{ending}"
    words = ["target", "export", "rings-10x8", "-o", str(path), "--json"]
    assert main(words) == 0
    told = json.loads(capsys.readouterr().out)
    assert (told["target"], told["file"]) == ("rings-10x8", str(path))
    assert told["dpi"] == (300 if ending == "png" else None)
    first = path.read_bytes()
    assert main(words) == 2
    assert "--force" in json.loads(capsys.readouterr().out)["error"]["message"]
    assert main([*words, "--force"]) == 0
    assert path.read_bytes() == first
    assert [entry.name for entry in tmp_path.iterdir()] == [path.name]


@pytest.mark.parametrize("dpi", ["0", "-3", "many", "99999"])
def test_export_refuses_a_resolution_that_cannot_be(dpi: str, tmp_path: Path) -> None:
    words = ["target", "export", "paper-13x10", "-o", str(tmp_path / "x.png"), "--dpi", dpi]
    assert main(words) == 2
    assert list(tmp_path.iterdir()) == []
