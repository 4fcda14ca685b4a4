"""Mistakes made on purpose: what the pictures show, what the manifest believes, and what the truth says."""

import json
from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from labcal.correspond.detections_csv import read_detections
from labcal.scene.mistakes import Mistake
from labcal.shoot.dataset import open_shoot
from labcal.shoot.truth import read_true_dots

Run = Callable[..., Any]

QUICK = ("--spp", 4, "--workers", 1, "--set", "photometry.bayer=off", "--set", "photometry.format=png")
VIEWS = ["train", "test-shifted"]


def rendered(labcal: Run, folder: Path, *changes: str, views: int = 2) -> dict[str, Any]:
    """Render the scene with one view to train on and one to test on, and return the truth."""
    words = [word for change in changes for word in ("--set", change)]
    told = labcal("render", "webcam-plane", "-o", folder, *QUICK, *words, "--views", views)
    assert told.status == 0
    content: dict[str, Any] = json.loads((folder / "truth" / "truth.json").read_text())
    return content


def require_truth_of_the_pictures(labcal: Run, folder: Path, share: float) -> None:
    """Raise unless dots are found in every picture where its own lines of dots.csv say they are."""
    path = folder.with_suffix(".csv")
    assert labcal("detect", folder, "-o", path, "--workers", 1).status == 0
    table = read_detections(path)
    for picture in read_true_dots(folder):
        found = table.where(table.ok & (table.view == picture.view) & (table.camera == picture.camera))
        assert len(found) >= share * picture.visible.sum() > 100 * share
        number = found.index[:, 1] * 13 + found.index[:, 0]
        distance = np.linalg.norm(found.position - picture.centroid[number], axis=1)
        assert np.sqrt((distance**2).mean()) < 0.15
        assert distance.max() < 0.6


@pytest.fixture(scope="module")
def plain(labcal: Run, tmp_path_factory: pytest.TempPathFactory) -> Path:
    """The shoot without a mistake."""
    folder = tmp_path_factory.mktemp("plain") / "shoot"
    truth = rendered(labcal, folder, "mistake=none")
    assert (truth["mistake"], truth["mistake_description"], truth["mistake_views"]) == (None, None, [])
    assert all(view["cameras"] == {} for view in truth["views"].values())
    return folder


@pytest.mark.parametrize("mistake", list(Mistake))
def test_dots_are_where_the_truth_of_their_own_picture_says(
    labcal: Run, plain: Path, tmp_path: Path, mistake: Mistake
) -> None:
    folder = tmp_path / "shoot"
    truth = rendered(labcal, folder, f"mistake={mistake}")
    require_truth_of_the_pictures(labcal, folder, 0.95)
    assert (folder / "shoot.json").read_bytes() == (plain / "shoot.json").read_bytes()  # nobody is told
    assert truth["mistake"] == mistake
    assert truth["mistake_description"].endswith(".")
    told = {
        (view, camera): {key for key, value in own.items() if value is not None}
        for view, true in truth["views"].items()
        for camera, own in true["cameras"].items()
    }
    expected = {
        Mistake.SWAPPED_CAMERAS: {
            ("test-shifted", camera): {"taken_by", "T_cam_world"} for camera in ("left", "right")
        },
        Mistake.CAMERA_KNOCKED: {("test-shifted", "right"): {"T_cam_world"}},
        Mistake.REFOCUSED: {("test-shifted", "right"): {"K"}},
        Mistake.UNSYNCHRONISED: {(view, "right"): {"T_world_target"} for view in VIEWS},
    }
    assert told == expected.get(mistake, {})
    later = {"swapped-cameras", "camera-knocked", "board-turned", "refocused"}
    changed = ["test-shifted"] if mistake in later else VIEWS
    assert truth["mistake_views"] == changed
    as_meant = json.loads((plain / "truth" / "truth.json").read_text())
    assert truth["cameras"] == as_meant["cameras"]
    for view in VIEWS:
        same = truth["views"][view]["T_world_target"] == as_meant["views"][view]["T_world_target"]
        assert same == (mistake is not Mistake.BOARD_TURNED or view == "train")


def test_swapped_pictures_are_the_other_cameras_own(labcal: Run, plain: Path, tmp_path: Path) -> None:
    rendered(labcal, tmp_path / "shoot", "mistake=swapped-cameras")
    for view in VIEWS:
        for camera, other in (("left", "right"), ("right", "left")):
            source = camera if view == "train" else other
            picture = (tmp_path / "shoot" / "images" / f"{view}_{camera}.png").read_bytes()
            assert picture == (plain / "images" / f"{view}_{source}.png").read_bytes()


def test_dots_of_a_moving_target_lie_where_their_rows_saw_them(labcal: Run, tmp_path: Path) -> None:
    folder = tmp_path / "shoot"
    movement = ("motion.velocity_mm_s=[150, 100, 0]", "motion.rotation_deg_s=[0, 0, 10]")
    truth = rendered(labcal, folder, *movement, "shutter=rolling", "readout_ms=20", views=1)
    require_truth_of_the_pictures(labcal, folder, 0.95)
    assert truth["views"]["train"]["T_world_target"][0][3] == 650.0  # in the middle of the frame
    left, right = (dots.point for dots in read_true_dots(folder)[:2])
    assert 0.05 < np.abs(left - right).max() < 3.0  # each camera saw each dot at a time of its own
    assert open_shoot(folder).nominal_poses()["train"][0, 3] == 650.0


def test_a_mistake_that_cannot_be_made_is_refused_before_anything_is_rendered(
    labcal: Run, tmp_path: Path
) -> None:
    for words, what in (
        (("webcam-handheld", "--set", "mistake=board-turned"), "board-turned"),
        (("webcam-plane", "--views", 1, "--set", "mistake=camera-knocked"), "camera-knocked"),
        (("webcam-plane", "--set", "motion.velocity_mm_s=[1e6, 0, 0]"), "sub-frames"),
        (("webcam-plane", "--set", "cameras.left.size=[1000000, 1000000]"), "should be at most 100000"),
    ):
        told = labcal("render", *words, "-o", tmp_path / "shoot", "--workers", 1)
        assert told.status == 2
        assert what in told.document["error"]["message"]
    assert list(tmp_path.iterdir()) == []
