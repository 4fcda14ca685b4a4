"""Cameras with parallel rays: rendered, detected, calibrated, reconstructed and evaluated."""

import json
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from labcal.correspond.detections_csv import read_detections
from labcal.shoot.truth import read_true_dots
from tests.system.conftest import Run

SCALE, CX, CY, COLS = 0.85, 639.5, 479.5, 13
DIST = (-1.5e-8, 3e-15, 5e-9, -8e-9, -5e-22)


@pytest.mark.slow
def test_from_the_picture_to_points(labcal: Run, tmp_path: Path) -> None:
    shoot, dots, rig, points = (tmp_path / name for name in ("shoot", "dots.csv", "rig.json", "points.csv"))
    changes = [
        word
        for camera in ("left", "right")
        for change in (
            "lens=telecentric",
            f"dist={list(DIST)}",
            "size=[1280, 960]",
            f"focal_px={SCALE}",
            f"principal_px=[{CX}, {CY}]",
        )
        for word in ("--set", f"cameras.{camera}.{change}")
    ]
    near = ("--set", "placement.spread_mm=[120, 150, 80]")
    options = ("--views", 14, "--spp", 16, "--workers", 1, "--set", "photometry=machine-vision-5mp")
    assert labcal("render", "webcam-handheld", "-o", shoot, *changes, *near, *options).status == 0
    assert labcal("detect", shoot, "-o", dots, "--workers", 1).status in (0, 1)
    told = labcal("calibrate", dots, "--target", "paper-13x10", "--lens", "telecentric", "-o", rig)
    assert told.status == 0
    for camera in told.document["cameras"].values():
        (fx, _, _), (_, fy, _), _ = camera["K"]
        sigma = camera["sigma"]
        found = np.array([fx, fy, *camera["dist"]])
        allowed = 3.0 * np.array([sigma["fx"], sigma["fy"], *sigma["dist"]])
        assert (np.abs(found - [SCALE, SCALE, *DIST]) < allowed).all()
    assert labcal("reconstruct", rig, dots, "-o", points).status in (0, 1)
    errors = labcal("evaluate", points, shoot, "--detections", dots).document
    assert (errors["alignment"], errors["n_ok"]) == ("rigid", errors["n"])
    cameras = json.loads((shoot / "truth" / "truth.json").read_text())["cameras"]
    # Errors are those that the pixels have by the truth, seen by exactly known cameras: the rig adds little.
    physical_mm = error_mm(cameras, pixel_error_px(dots, shoot))
    assert errors["rmse_mm"] == pytest.approx(physical_mm, rel=0.05)
    stated_px = np.sqrt(np.diagonal(read_detections(dots).covariance.mean(axis=0)))
    assert errors["limit_mm"] == pytest.approx(error_mm(cameras, stated_px), rel=0.02)


def pixel_error_px(table: Path, shoot: Path) -> np.ndarray:
    """Return the RMS error of centroids along x and along y."""
    dots, off = read_detections(table), []
    for picture in read_true_dots(shoot):
        own = dots.where(dots.ok & (dots.view == picture.view) & (dots.camera == picture.camera))
        off.append(own.position - picture.centroid[own.index[:, 1] * COLS + own.index[:, 0]])
    return np.sqrt((np.concatenate(off) ** 2).mean(axis=0))


def error_mm(cameras: dict[str, dict[str, Any]], sigma_px: np.ndarray) -> float:
    """Return the RMS error of points that two cameras with parallel rays see with an error along x and y.

    The axes stand at an angle a, in a plane in which both x axes nearly lie: there one camera measures x and
    the other one x cos a - z sin a. The coordinate across that plane is measured twice.
    """
    left, right = (np.array(cameras[name]["T_cam_world"]) for name in ("left", "right"))
    cosine = float(left[2, :3] @ right[2, :3])
    x, y = (sigma_px / SCALE) ** 2
    return float(np.sqrt(x * (1.0 + (1.0 + cosine**2) / (1.0 - cosine**2)) + 0.5 * y))
