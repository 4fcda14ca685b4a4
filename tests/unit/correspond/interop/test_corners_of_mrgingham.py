"""A chessboard that mrgingham itself has found, against its true corners."""

import shutil
import subprocess
from pathlib import Path

import cv2
import numpy as np
import pytest

from labcal.correspond.interop.corners_vnl import read_corners
from labcal.errors import InputError
from labcal.targets.grid import DotGrid

K = np.array([[760.0, 0.0, 330.0], [0.0, 760.0, 235.0], [0.0, 0.0, 1.0]])
D = np.array([-0.15, 0.05, 0.0, 0.0, 0.0])
N, PITCH, SCALE = 10, 20.0, 4
SIZE = (640, 480)


def projected(points: np.ndarray, tilt_deg: tuple[float, float, float]) -> np.ndarray:
    """Return pixels of points on a board that is seen upright: x to the right, y up."""
    turn = cv2.Rodrigues(np.radians(np.array(tilt_deg)))[0] @ np.diag([1.0, -1.0, -1.0])
    middle = PITCH * (N - 1) / 2 * np.array([1.0, 1.0, 0.0])
    t = np.array([0.0, 0.0, 480.0]) - turn @ middle
    flat = np.column_stack([points, np.zeros(len(points))])
    return cv2.projectPoints(flat, cv2.Rodrigues(turn)[0], t, K, D)[0][:, 0]


@pytest.mark.skipif(shutil.which("mrgingham") is None, reason="mrgingham is not installed")
def test_corners_of_mrgingham_are_those_of_the_board(tmp_path: Path) -> None:
    tilt = (18.0, -14.0, 6.0)
    picture = np.full((SIZE[1] * SCALE, SIZE[0] * SCALE), 210, np.uint8)
    for i in range(-1, N):
        for j in range(-1, N):
            if (i + j) % 2:
                continue
            square = PITCH * (np.array([(0, 0), (1, 0), (1, 1), (0, 1)]) + np.array([i, j]))
            q = ((projected(square, tilt) + 0.5) * SCALE - 0.5) * 16
            cv2.fillPoly(picture, [np.round(q).astype(np.int32)], 40, shift=4)
    path = tmp_path / "v1.png"
    cv2.imwrite(str(path), cv2.resize(picture, SIZE, interpolation=cv2.INTER_AREA))
    program = str(shutil.which("mrgingham"))
    found = subprocess.run([program, str(path)], check=True, capture_output=True, text=True)
    (tmp_path / "corners.vnl").write_text(found.stdout)
    target = DotGrid(
        name="corners", cols=N, rows=N, pitch_x_mm=PITCH, pitch_y_mm=PITCH, dot_diameter_mm=PITCH / 1000.0,
        margin_mm=PITCH, rings=None,
    )  # fmt: skip
    read = read_corners(tmp_path / "corners.vnl", target, {}, lambda _: SIZE).detections
    miss = read.position - projected(PITCH * read.index.astype(np.float64), tilt)
    assert read.ok.all()
    assert np.abs(miss).max() < 1.5  # px, of 30 between corners
    assert np.abs(miss.mean(axis=0)).max() < 0.1  # both count from the centre of the first pixel


def test_a_size_in_which_a_corner_cannot_be_is_refused(tmp_path: Path) -> None:
    path = tmp_path / "corners.vnl"
    target = DotGrid(
        name="corners", cols=2, rows=2, pitch_x_mm=PITCH, pitch_y_mm=PITCH, dot_diameter_mm=PITCH / 1000.0,
        margin_mm=PITCH, rings=None,
    )  # fmt: skip
    lines = [f"v1.png {x} {y} 0" for x, y in ((0.0, 0.25), (639.4, 20.0), (20.0, 479.4), (600.0, 470.0))]
    path.write_text("\n".join(["# filename x y level", *lines]))
    assert read_corners(path, target, {}, lambda _: SIZE).detections.ok.all()
    for size, dot, at in (((640, 400), r"\(0, 0\)", r"\(20\.0, 479\.4\)"), ((630, 480), r"\(1, 1\)", "")):
        message = (
            rf"corners\.vnl: Dot {dot} in view 'v1' .* at {at}.* lies outside of its picture of {size[0]} x"
        )
        with pytest.raises(InputError, match=message):
            read_corners(path, target, {}, lambda _, size=size: size)
