"""Cameras with parallel rays: rendered, detected, calibrated, reconstructed and evaluated."""

from pathlib import Path

import numpy as np
import pytest

from tests.system.conftest import Run

SCALE, CX, CY = 0.85, 639.5, 479.5
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
    errors = labcal("evaluate", points, shoot).document
    # 0.0127 px along each axis, 14 degrees apart: 0.09 mm in depth. The mirror image would leave tens.
    assert (errors["alignment"], errors["n_ok"]) == ("rigid", errors["n"])
    assert errors["rmse_mm"] < 0.15
