"""Cameras with lenses of the unified family: rendered, detected, calibrated, written and read."""

from pathlib import Path

import numpy as np
import pytest

from labcal.cameras.rig_file import read_rig
from tests.system.conftest import Run

LENSES = {
    "double-sphere": ((-0.2, 0.6), 260.0),
    "eucm": ((0.6, 1.1), 300.0),
    "omni-radtan": ((1.2, -0.1, 0.02, 0.0006, -0.0004), 660.0),
}
CX, CY = 320.0, 241.0


@pytest.mark.slow
@pytest.mark.parametrize("lens", LENSES)
def test_from_the_picture_to_the_lens_and_back(labcal: Run, lens: str, tmp_path: Path) -> None:
    dist, focal = LENSES[lens]
    shoot, dots, rig = tmp_path / "shoot", tmp_path / "dots.csv", tmp_path / "rig.json"
    changes = [
        word
        for camera in ("left", "right")
        for change in (
            f"lens={lens}",
            f"dist={list(dist)}",
            f"focal_px={focal}",
            f"principal_px=[{CX}, {CY}]",
        )
        for word in ("--set", f"cameras.{camera}.{change}")
    ]
    near = ("--set", "placement.centre_mm=[1000, 400, 900]", "--set", "placement.spread_mm=[450, 250, 350]")
    options = ("--views", 14, "--spp", 16, "--workers", 1, "--set", "photometry=machine-vision-5mp")
    assert labcal("render", "webcam-handheld", "-o", shoot, *changes, *near, *options).status == 0
    assert labcal("detect", shoot, "-o", dots, "--workers", 1).status in (0, 1)
    told = labcal("calibrate", dots, "--target", "paper-13x10", "--lens", lens, "-o", rig)
    assert told.status == 0
    for camera in told.document["cameras"].values():
        (fx, _, cx), (_, fy, cy), _ = camera["K"]
        sigma = camera["sigma"]
        found = np.array([fx, fy, cx, cy, *camera["dist"][: len(dist)]])
        allowed = 3.0 * np.array([*(sigma[name] for name in ("fx", "fy", "cx", "cy")), *sigma["dist"]])
        assert (np.abs(found - [focal, focal, CX, CY, *dist]) < allowed).all()
    chain, back = tmp_path / "camchain.yaml", tmp_path / "back.json"
    assert labcal("convert", rig, chain, "--to", "kalibr").status == 0
    assert labcal("convert", chain, back).status == 0
    for name, record in read_rig(rig).cameras.items():
        read = read_rig(back).cameras[name]
        assert (read.lens, read.dist, read.K) == (lens, record.dist, record.K)
