"""Calibrating from pictures that contradict each other, and points from such a rig, on the command line."""

import csv
import json
from collections.abc import Callable
from dataclasses import replace
from pathlib import Path
from typing import Any

import cv2
import numpy as np
import pytest
import yaml

from labcal.bench.solve.held_rig import TARGET, HeldRig
from labcal.correspond.detections import Detections
from labcal.correspond.detections_csv import detections_csv

Run = Callable[..., Any]


@pytest.fixture(scope="module")
def target(tmp_path_factory: pytest.TempPathFactory) -> Path:
    path = tmp_path_factory.mktemp("target") / "held.yaml"
    path.write_text(yaml.safe_dump(TARGET.model_dump(mode="json")))
    return path


def write(path: Path, dots: Detections) -> Path:
    path.write_text(detections_csv(dots))
    return path


def knocked(dots: Detections) -> Detections:
    """Return dots as if the second camera had been turned a little half-way: by 0.3 px each way."""
    later = np.isin(dots.view, dots.views[len(dots.views) // 2 :]) & (dots.camera == "right")
    return replace(dots, position=dots.position + later[:, None] * [0.3, 0.3])


def test_a_contradictory_rig_is_told_and_its_points_are_flagged(
    labcal: Run, tmp_path: Path, target: Path
) -> None:
    dots = HeldRig.drawn(8, 3).detections()
    good, bad = write(tmp_path / "good.csv", dots), write(tmp_path / "bad.csv", knocked(dots))
    words = ("--target", target, "--lens", "brown5")
    told = labcal("calibrate", good, *words, "-o", tmp_path / "good.json")
    assert told.status == 0
    assert told.document["inconsistent"] is None
    assert told.document["triangulation_rms_px"] == pytest.approx(0.05 / np.sqrt(2.0), rel=0.15)
    told = labcal("calibrate", bad, *words, "-o", tmp_path / "bad.json")
    assert told.status == 1
    inconsistent = told.document["inconsistent"]
    assert inconsistent["causes"][0]["cause"] == "camera-moved"
    assert inconsistent["views"] == ["pose-4", "pose-5", "pose-6", "pose-7"]
    assert inconsistent["rms_in_rig_px"] > inconsistent["rms_alone_px"]
    rig = json.loads((tmp_path / "bad.json").read_text())
    assert rig["calibration"]["inconsistent"][0] == "camera-moved"

    told = labcal("reconstruct", tmp_path / "bad.json", good, "--target", target, "-o", tmp_path / "p.csv")
    assert told.status == 1
    assert told.document["inconsistent"]["causes"][0] == "camera-moved"
    assert set(told.document["flags"]) == {"model-misfit"}
    told = labcal("reconstruct", tmp_path / "good.json", good, "--target", target, "-o", tmp_path / "q.csv")
    assert told.status == 0
    assert told.document["inconsistent"] is None
    assert told.document["flags"].get("ok", 0) > 0.99 * told.document["n"]
    told = labcal("reconstruct", tmp_path / "good.json", bad, "--target", target, "-o", tmp_path / "r.csv")
    assert told.status == 1
    assert told.document["inconsistent"]["views"] == ["pose-4", "pose-5", "pose-6", "pose-7"]
    with (tmp_path / "r.csv").open() as lines:
        flags = {(row["view"] > "pose-3", row["flag"]) for row in csv.DictReader(lines)}
    assert (True, "ok") not in flags
    assert (False, "ok") in flags


def test_a_rig_keeps_its_finding_when_it_is_converted(labcal: Run, tmp_path: Path, target: Path) -> None:
    dots = HeldRig.drawn(6, 4).detections()
    bad = write(tmp_path / "bad.csv", knocked(dots))
    labcal("calibrate", bad, "--target", target, "-o", tmp_path / "rig.json")
    told = labcal("convert", tmp_path / "rig.json", tmp_path / "rig.yml", "--to", "opencv")
    assert told.status == 1
    assert told.document["inconsistent"]
    assert any("contradict each other" in note for note in told.document["notes"])
    # OpenCV's file has no place for it: the points say that what the calibration left is assumed.
    labcal("convert", tmp_path / "rig.yml", tmp_path / "back.json", "--to", "labcal")
    told = labcal("reconstruct", tmp_path / "back.json", bad, "-o", tmp_path / "points.csv")
    assert told.document["expected_assumed"] is True
    labcal("convert", tmp_path / "rig.json", tmp_path / "again.json", "--to", "labcal")
    rig = json.loads((tmp_path / "again.json").read_text())
    assert rig["calibration"]["inconsistent"]
    width, height = rig["cameras"]["left"]["size"]
    (tmp_path / "pictures").mkdir()
    cv2.imwrite(str(tmp_path / "pictures" / "a_left.png"), np.full((height, width), 99, np.uint8))
    words = ("--cameras", "_left=left", "-o", tmp_path / "undistorted")
    told = labcal("undistort", tmp_path / "rig.json", tmp_path / "pictures", *words)
    assert told.status == 1
    assert "contradict each other" in told.said


@pytest.mark.slow
def test_pictures_exchanged_half_way_are_told_as_that(labcal: Run, tmp_path: Path, target: Path) -> None:
    dots = HeldRig.drawn(6, 4).detections()
    later = np.isin(dots.view, dots.views[3:])
    other = np.where(dots.camera == "left", "right", "left")
    swapped = write(tmp_path / "swapped.csv", replace(dots, camera=np.where(later, other, dots.camera)))
    told = labcal("calibrate", swapped, "--target", target, "-o", tmp_path / "rig.json")
    assert told.status == 2  # these fit no rig at all
    message = told.document["error"]["message"]
    assert message.startswith("The cameras contradict each other")
    assert "are exchanged in 3 of 6 views" in message
