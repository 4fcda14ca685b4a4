"""Lengths in views that no calibration has seen."""

import json
import subprocess
import sys
from pathlib import Path

import numpy as np
import pytest

from labcal import InputError, LengthErrors, examples, load_target, pipeline, write_detections
from labcal.calibrate.calibrated import calibrated
from labcal.evaluate.held_out_lengths import HeldOutLengths
from labcal.evaluate.own_lengths import errors_of_lengths
from labcal.reconstruct.reconstruction import reconstruct_centres
from labcal.run.json_text import plain_data

TARGET = load_target(examples.TARGET)


@pytest.fixture(scope="module")
def found() -> HeldOutLengths:
    return pipeline.evaluate_held_out(TARGET, examples.detections(), parts=2)


def test_every_view_is_scored_once_by_cameras_that_have_not_seen_it(found: HeldOutLengths) -> None:
    views = examples.detections().views
    assert sorted(found.views_scored) == sorted(views)
    assert found.views_calibrated_on == 0
    assert [part.views for part in found.parts] == [views[::2], views[1::2]]
    assert [part.calibrated_on for part in found.parts] == [4, 4]
    assert not any("circular" in warning for warning in found.warnings)


def test_a_part_is_what_calibrate_reconstruct_and_evaluate_give_by_hand(found: HeldOutLengths) -> None:
    dots, held = examples.detections(), examples.detections().views[::2]
    made = calibrated(dots, TARGET, hold_out=held)
    points = reconstruct_centres(made.rig, dots.where(np.isin(dots.view, held)), TARGET).points
    by_hand = errors_of_lengths(points, TARGET, made.calibrated_on)
    part = found.parts[0]
    assert (part.n, part.rms_mm, part.scale_ppm) == (
        by_hand.n, by_hand.length_error_mm.rms, by_hand.scale_ppm
    )  # fmt: skip
    assert np.array_equal(found.error[: part.n], by_hand.error)


@pytest.mark.slow
def test_lengths_held_out_err_more_than_those_that_calibrated(found: HeldOutLengths) -> None:
    made = calibrated(examples.detections(), TARGET)
    points = reconstruct_centres(made.rig, examples.detections(), TARGET).points
    seen = errors_of_lengths(points, TARGET, made.calibrated_on)
    assert any("circular" in warning for warning in seen.warnings)
    assert found.length_error_mm.rms > seen.length_error_mm.rms


def test_lengths_of_which_nothing_is_known_are_warned_of() -> None:
    unknown = pipeline.evaluate(examples.points(), TARGET)
    assert isinstance(unknown, LengthErrors)
    assert any("no proof" in warning for warning in unknown.warnings)
    known = pipeline.evaluate(examples.points(), TARGET, rig=["another-view"])
    assert not known.warnings


@pytest.mark.parametrize("parts", [1, 9])
def test_parts_that_cannot_be_are_refused(parts: int) -> None:
    with pytest.raises(InputError, match=r"8 views can be held out in 2 to 8 parts|at least 2"):
        pipeline.evaluate_held_out(TARGET, examples.detections(), parts=parts)


def test_too_few_other_views_are_said_with_those_held_out() -> None:
    dots = examples.detections()
    few = dots.where(np.isin(dots.view, dots.views[:4]))
    with pytest.raises(InputError, match="With hand-0, hand-2 held out: Camera 'left' has 2 usable views"):
        pipeline.evaluate_held_out(TARGET, few, parts=2)


@pytest.mark.slow
def test_the_command_gives_the_same(tmp_path: Path) -> None:
    write_detections(tmp_path / "dots.csv", examples.detections())
    found = pipeline.evaluate_held_out(TARGET, tmp_path / "dots.csv", parts=2)
    command = [sys.executable, "-m", "labcal", "evaluate", "dots.csv", "--target", examples.TARGET]
    done = subprocess.run(
        [*command, "--holdout", "2", "--json"], cwd=tmp_path, check=True, capture_output=True, text=True
    )
    assert json.loads(done.stdout) == json.loads(json.dumps(plain_data(found)))


def test_what_goes_with_dots_alone_is_refused_with_points(tmp_path: Path) -> None:
    command = [sys.executable, "-m", "labcal", "evaluate", "points.csv", "--target", examples.TARGET]
    done = subprocess.run(
        [*command, "--lens", "brown5"], cwd=tmp_path, check=False, capture_output=True, text=True
    )
    assert done.returncode == 2
    assert "--holdout" in done.stderr
