"""Python and the command line give the same bytes, and README's example is what it says."""

import re
from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from labcal import pipeline
from labcal.cameras.rig_file import read_rig, write_rig
from labcal.cli.option_words import in_options
from labcal.correspond.detections_csv import detections_csv, read_detections
from labcal.correspond.points_csv import points_csv, read_points
from labcal.estimators.model_file import load_model, save_model
from labcal.shoot.dataset import open_shoot
from labcal.targets.catalogue import load_target

Run = Callable[..., Any]
README = Path(__file__).parents[2] / "README.md"


def python_block() -> str:
    blocks = re.findall(r"```python\n(.*?)```", README.read_text(), flags=re.DOTALL)
    (block,) = (one for one in blocks if "pipeline.render(" in one)  # the others are methods of one's own
    return str(block)


def python_output() -> str:
    (block,) = re.findall(r"It prints.*?```\n(.*?)```", README.read_text(), flags=re.DOTALL)
    return str(block)


def same_as_the_command(labcal: Run, shoot: Path, dots: Path, method: str, home: Path) -> None:
    """Compare model, points and errors of one method."""
    opened, detections = open_shoot(shoot), read_detections(dots)
    model = pipeline.fit(opened, detections, method)
    save_model(home / "python", model, force=False)
    found = pipeline.reconstruct(model, detections, opened.target)
    errors = pipeline.evaluate(found.points, opened, detections)

    told = labcal("fit", shoot, "--detections", dots, "--method", method, "-o", home / "command")
    assert told.status == 0
    assert (home / "command").read_bytes() == (home / "python").read_bytes()
    words = ("--target", opened.target.name, "-o", home / "points.csv")
    told = labcal("reconstruct", home / "command", dots, *words)
    assert (home / "points.csv").read_text() == points_csv(found.points)
    assert told.document["warnings"] == list(found.warnings)
    for warning in found.warnings:
        assert in_options(warning) in told.said.replace("\n", " ")
    told = labcal("evaluate", home / "points.csv", shoot, "--detections", dots).document
    assert told["rmse_mm"] == errors.rmse_mm
    assert told["mean_signed_mm"] == list(errors.mean_signed_mm)
    assert told["n"] == errors.n


@pytest.mark.parametrize("method", ["homography", "mlp"])
def test_a_method_learns_the_same_from_python(
    labcal: Run, stage: Path, stage_dots: Path, tmp_path: Path, method: str
) -> None:
    same_as_the_command(labcal, stage, stage_dots, method, tmp_path)


@pytest.mark.slow
def test_what_a_method_cannot_is_flagged_in_python_too(labcal: Run, tmp_path: Path) -> None:
    shoot, dots = tmp_path / "shoot", tmp_path / "dots.csv"
    options = ("--spp", 16, "--set", "photometry.bayer=off")
    assert labcal("render", "webcam-volume", "-o", shoot, *options).status == 0
    assert labcal("detect", shoot, "-o", dots).status == 0
    same_as_the_command(labcal, shoot, dots, "dlt", tmp_path)
    flags = read_points(tmp_path / "points.csv").flag.tolist()
    assert "model-misfit" in flags  # it knows no lens, and the webcams have one
    assert "ok" not in flags


def test_a_calibration_is_the_same_from_python(
    labcal: Run, handheld: Path, handheld_dots: Path, tmp_path: Path
) -> None:
    detections, target = read_detections(handheld_dots), load_target("paper-13x10")
    made = pipeline.calibrate(target, detections, "brown-k1k2")
    write_rig(tmp_path / "python.json", made.rig)
    words = ("--target", "paper-13x10", "--lens", "brown-k1k2", "-o", tmp_path / "command.json")
    told = labcal("calibrate", handheld_dots, *words)
    assert told.status == 0
    assert (tmp_path / "command.json").read_bytes() == (tmp_path / "python.json").read_bytes()
    rig = read_rig(tmp_path / "command.json")
    assert rig.calibrated_on == detections.views
    for warning in made.warnings:
        assert in_options(warning) in told.said.replace("\n", " ")
    assert detections_csv(pipeline.detect(open_shoot(handheld))) == handheld_dots.read_text()
    found = pipeline.reconstruct(rig, detections, target)
    np.testing.assert_array_equal(
        pipeline.reconstruct(made.rig, detections, target).points.point, found.points.point
    )


@pytest.mark.slow
def test_the_example_of_the_readme_is_what_the_commands_give(
    labcal: Run, tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    monkeypatch.chdir(tmp_path)
    named: dict[str, Any] = {}
    exec(python_block(), named)  # noqa: S102 -- the README's own words
    printed = capsys.readouterr().out
    shoot, dots = Path("out/shoot"), Path("detections.csv")
    assert labcal("detect", shoot, "-o", dots).status == 0
    assert labcal("fit", shoot, "--detections", dots, "--method", "mlp", "-o", "model").status == 0
    words = ("--target", "paper-13x10", "-o", "points.csv")
    assert labcal("reconstruct", "model", dots, *words).status in (0, 1)
    told = labcal("evaluate", "points.csv", shoot, "--detections", dots).document
    assert told["rmse_mm"] == named["errors"].rmse_mm
    assert repr(named["errors"]) in printed
    assert python_output().splitlines()[:3] == printed.splitlines()[:3]  # then a network's figures
    assert load_model(Path("model")).rehearsed == named["model"].rehearsed
