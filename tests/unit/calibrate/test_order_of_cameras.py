"""The world of a rig is its first camera: also where the first picture of that camera is lost."""

from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

from labcal import examples, pipeline

LENS = "brown-k1k2"


def test_a_first_picture_without_measured_dots_does_not_change_the_world() -> None:
    dots = examples.detections()
    lost = (dots.view == dots.views[0]) & (dots.camera == "left")
    partly = replace(dots, flag=np.where(lost, "bad-fit", dots.flag))
    found = pipeline.calibrate(examples.TARGET, partly, LENS)
    assert list(found.rig.cameras) == ["left", "right"]


def test_a_first_picture_that_is_refused_does_not_change_the_world_of_a_shoot(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.chdir(tmp_path)
    dots = examples.detections()
    rest = dots.where(~((dots.view == dots.views[0]) & (dots.camera == "left")))
    assert rest.cameras == ("right", "left")
    shoot = examples.shoot("shoot", views=1)
    found = pipeline.calibrate(shoot, rest, LENS, hold_out="none")
    assert list(found.rig.cameras) == ["left", "right"]


def test_lines_in_the_order_of_cameras() -> None:
    dots = examples.detections()
    turned = dots.with_cameras_in_order(["other", "right", "left"])
    assert turned.cameras == ("right", "left")
    assert turned.with_cameras_in_order(["left"]).cameras == ("left", "right")
    assert dots.with_cameras_in_order(["left", "right"]) is dots
    assert sorted(turned.position[:, 0].tolist()) == sorted(dots.position[:, 0].tolist())
