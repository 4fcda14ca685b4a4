"""Real photographs and other people's renderings of dot targets; skipped where they are not at hand."""

import os
from pathlib import Path

import cv2
import numpy as np
import pytest

from labcal.detect.detector import detect_dots
from labcal.targets.catalogue import load_target

FOLDER = Path(os.environ.get("LABCAL_REAL_DATA", Path(__file__).parents[2] / ".." / "shared" / "real"))

pytestmark = pytest.mark.skipif(not FOLDER.is_dir(), reason="the real pictures are not at hand")

CAMERAS = [
    ("photos", "*_0.jpeg", "rings-10x8", 7, 0.6),
    ("photos", "*_1.jpeg", "rings-10x8", 7, 0.6),
    ("rendered_black", "*_0.jpeg", "rings-14x10", 10, 0.009),
    ("rendered_black", "*_1.jpeg", "rings-14x10", 10, 0.009),
    ("rendered_white", "*.jpeg", "rings-14x10", 5, 0.009),
]


@pytest.mark.parametrize(("folder", "pattern", "name", "count", "limit"), CAMERAS)
def test_every_picture_is_indexed_and_calibrates(
    folder: str, pattern: str, name: str, count: int, limit: float
) -> None:
    target = load_target(name)
    pictures = sorted((FOLDER / folder).glob(pattern))
    assert len(pictures) == count
    points, pixels, size = [], [], (0, 0)
    for path in pictures:
        dots = detect_dots(cv2.imread(str(path), cv2.IMREAD_UNCHANGED), target)
        assert dots.refusal is None, path
        assert dots.ok.sum() > 70, path
        size = dots.size
        points.append(target.points(dots.index[dots.ok]).astype(np.float32))
        pixels.append(dots.position[dots.ok].astype(np.float32))
    flags = cv2.CALIB_ZERO_TANGENT_DIST | cv2.CALIB_FIX_K3
    rms, K, dist, rotations, shifts = cv2.calibrateCamera(points, pixels, size, None, None, flags=flags)
    assert rms < limit
    # A dot with a wrong id would be off by a grid step, which is 60 px and more here.
    for p, q, rotation, shift in zip(points, pixels, rotations, shifts, strict=True):
        worst = np.abs(cv2.projectPoints(p, rotation, shift, K, dist)[0][:, 0] - q).max()
        assert worst < 5 * limit + 0.1
