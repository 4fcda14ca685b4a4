"""Targets other than grids with rings, through the commands: rendered, or drawn through OpenCV's camera."""

import json
from collections.abc import Callable
from pathlib import Path
from typing import Any

import cv2
import numpy as np
import pytest

from labcal.correspond.detections_csv import read_detections
from labcal.shoot.truth import read_true_dots
from labcal.targets.catalogue import load_target

Run = Callable[..., Any]

ASYMMETRIC = """
name: leaning
layout: asymmetric
cols: 4
rows: 7
pitch_x_mm: 120
pitch_y_mm: 60
dot_diameter_mm: 64 # wider than the rows are apart
rings: null
margin_mm: 60
"""
PLAIN = """
name: alike
cols: 7
rows: 5
pitch_x_mm: 70
pitch_y_mm: 60
dot_diameter_mm: 30
polarity: white-on-black
rings: null
margin_mm: 40
"""
FOUND = (("leaning", ASYMMETRIC, 1), ("alike", PLAIN, 2))


@pytest.mark.parametrize(("name", "text", "numberings"), FOUND, ids=lambda x: str(x)[:7])
def test_grids_without_rings_are_rendered_and_found(
    name: str, text: str, numberings: int, labcal: Run, tmp_path: Path
) -> None:
    (tmp_path / f"{name}.yaml").write_text(text)
    shoot, table = tmp_path / "shoot", tmp_path / "dots.csv"
    settings = (f"target={tmp_path / name}.yaml", "photometry.bayer=off")
    options = [word for setting in settings for word in ("--set", setting)]
    done = labcal(
        "render", "webcam-handheld", "-o", shoot, "--views", 1, "--spp", 8, "--workers", 1, *options
    )
    assert done.status == 0
    told = labcal("detect", shoot, "-o", table, "--workers", 1)
    assert (told.status, told.document["indexed"]) == (0, 2)
    assert {image["numberings"] for image in told.document["images"]} == {numberings}
    assert ("looks the same when it is turned" in told.said) == (numberings > 1)
    target = load_target(str(tmp_path / f"{name}.yaml"))
    dots = read_detections(table)
    turned: dict[str, set[bool]] = {}
    for picture in read_true_dots(shoot):
        assert picture.visible.all()  # a grid without rings is wanted whole
        found = dots.where(dots.ok & (dots.view == picture.view) & (dots.camera == picture.camera))
        assert len(found) == target.count
        misses = []
        for index in (found.index, *target.symmetric_indices(found.index)):
            number = index[:, 1] * target.cols + index[:, 0]
            misses.append(np.linalg.norm(found.position - picture.centroid[number], axis=1).max())
        assert min(misses) < 0.4
        turned.setdefault(picture.view, set()).add(bool(misses[0] > 0.4))
    assert all(len(ways) == 1 for ways in turned.values())  # both cameras say the same
    assert numberings > 1 or turned == {view: {False} for view in turned}


def draw_charuco(T: np.ndarray, K: np.ndarray, dist: np.ndarray, size: tuple[int, int]) -> np.ndarray:
    """Return a picture of the board charuco-12x9, OpenCV's own drawing of it seen by OpenCV's camera."""
    fine, per_mm, margin = 3, 10, 100
    dictionary = cv2.aruco.getPredefinedDictionary(cv2.aruco.DICT_5X5_100)
    art = cv2.aruco.CharucoBoard((12, 9), 20.0, 15.0, dictionary).generateImage((2400, 1800))
    art = cv2.copyMakeBorder(art, margin, margin, margin, margin, cv2.BORDER_CONSTANT, value=255)
    soft = 0.3 * T[2, 3] / K[0, 0] * per_mm
    art = cv2.GaussianBlur(art.astype(np.float32), (0, 0), soft)
    x, y = ((np.arange(n * fine) + 0.5) / fine - 0.5 for n in size)
    q = np.stack(np.meshgrid(x, y), axis=-1).reshape(-1, 1, 2)
    rays = cv2.undistortPoints(q, K, dist, criteria=(3, 10, 1e-7)).reshape(-1, 2)
    on_board = np.linalg.inv(T[:3, [0, 1, 3]]) @ np.concatenate([rays, np.ones((len(rays), 1))], axis=1).T
    places = (on_board[:2] / on_board[2]).astype(np.float32)
    # labcal's origin is the lower left inner corner; OpenCV draws from the upper left one of the board.
    across = ((places[0] + 20.0) * per_mm - 0.5 + margin).reshape(size[1] * fine, size[0] * fine)
    down = ((160.0 - places[1]) * per_mm - 0.5 + margin).reshape(across.shape)
    seen = cv2.remap(art, across, down, cv2.INTER_LINEAR, borderMode=cv2.BORDER_REPLICATE)
    picture: np.ndarray = cv2.GaussianBlur(seen, (0, 0), 0.5 * fine)
    return 10 + 0.75 * picture.reshape(size[1], fine, size[0], fine).mean(axis=(1, 3))


def test_a_charuco_board_calibrates_a_pair(labcal: Run, tmp_path: Path) -> None:
    size, rng = (400, 300), np.random.default_rng(5)
    K, dist = np.array([[420.0, 0, 203.0], [0, 424.0, 146.0], [0, 0, 1]]), np.array([-0.2, 0.05, 0, 0, 0])
    T_right_left = np.eye(4)
    T_right_left[:3, :3] = cv2.Rodrigues(np.array([0.01, 0.2, 0.05]))[0]
    T_right_left[:3, 3] = [-70.0, 3.0, 8.0]
    folder = tmp_path / "pictures"
    folder.mkdir()
    for number in range(4):
        tilt = cv2.Rodrigues(rng.uniform(-0.5, 0.5, 3) * [1, 1, 0.5])[0]
        T = np.eye(4)
        T[:3, :3] = np.diag([1.0, -1.0, -1.0]) @ tilt
        T[:3, 3] = rng.uniform([-10, -20, 310], [50, 20, 380]) - T[:3, :3] @ [100.0, 70.0, 0.0]
        for ending, pose in (("0", T), ("1", T_right_left @ T)):
            picture = draw_charuco(pose, K, dist, size) + rng.normal(0, 1.5, size[::-1])
            cv2.imwrite(str(folder / f"v{number}_{ending}.png"), np.clip(np.round(picture), 0, 255))
    dots, rig = tmp_path / "dots.csv", tmp_path / "rig.json"
    words = ("--target", "charuco-12x9", "--cameras", "_0=left,_1=right", "--workers", 1)
    told = labcal("detect", folder, "-o", dots, "--overlay", tmp_path / "overlay", *words)
    assert (told.status, told.document["indexed"], told.document["images"][0]["expected"]) == (0, 8, 88)
    assert len(list((tmp_path / "overlay").glob("*.png"))) == 8
    told = labcal("calibrate", dots, "--target", "charuco-12x9", "--lens", "brown-k1k2", "-o", rig)
    assert told.status == 0
    assert told.document["rms_px"] < 0.02
    cameras = json.loads(rig.read_text())["cameras"]
    for name in ("left", "right"):
        np.testing.assert_allclose(np.array(cameras[name]["K"]), K, atol=0.8)
        np.testing.assert_allclose(cameras[name]["dist"][:2], dist[:2], atol=0.02)
    np.testing.assert_allclose(np.array(cameras["right"]["T_cam_world"]), T_right_left, atol=0.2)
