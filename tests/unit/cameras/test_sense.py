"""Cameras that no careful reader would take, whatever file they are in."""

import json
from pathlib import Path

import numpy as np
import pytest

from labcal.cameras.blind_pixels import require_rays_everywhere
from labcal.cameras.camera import Camera
from labcal.cameras.interop.exchange import Home
from labcal.cameras.interop.registry import FORMATS
from labcal.cameras.interop.rig_files import read_rig_files, write_rig_files
from labcal.cameras.record import CameraRecord
from labcal.cameras.rig import Rig
from labcal.cameras.rig_file import read_rig, write_rig
from labcal.errors import InputError

K = np.array([[702.0, 0.0, 320.0], [0.0, 700.0, 240.0], [0.0, 0.0, 1.0]])


def camera(dist: list[float] | None = None) -> Camera:
    return Camera(K, "brown5", np.array(dist or [-0.1, 0.01, 0.0, 0.0, 0.0]), np.eye(4), (640, 480))


@pytest.mark.parametrize(
    ("place", "value", "said"),
    [
        (("K", 0, 0), 2147483648.0, "focal length fx"),
        (("K", 0, 0), -702.0, "focal length fx"),
        (("K", 1, 1), 9000.0, "differ by more than a factor"),
        (("K", 0, 2), 1e6, "principal point"),
        (("dist", 0), 1e30, r"dist\[0\]"),
        (("dist", 4), -1e9, r"dist\[4\]"),
        (("dist", 0), -50.0, "sees no direction"),
        (("size", 0), 0, "at least 1"),
        (("size", 0), 2**31, "at most 100000"),
        (("T_cam_world", 0, 0), 1.01, "rigid"),
        (("T_cam_world", 0, 0), -1.0, "rigid"),
        (("T_cam_world", 0, 3), 1e12, "moves by more than"),
        (("T_cam_world", 3, 3), 2.0, "rigid"),
        (("T_cam_world", 1, 1), 1e300, "rigid"),
    ],
)
def test_a_rig_that_can_be_none_is_refused_by_name(
    place: tuple[str | int, ...], value: float, said: str, tmp_path: Path
) -> None:
    path = tmp_path / "rig.json"
    write_rig(path, Rig.of({"left": camera()}))
    content = json.loads(path.read_text())
    node = content["cameras"]["left"]
    for step in place[:-1]:
        node = node[step]
    node[place[-1]] = value
    path.write_text(json.dumps(content))
    with pytest.raises(InputError, match=said):
        read_rig(path)


TEXTS = [name for name, one in FORMATS.items() if one.home is Home.FILE and not one.binary]


@pytest.mark.parametrize("name", [name for name in TEXTS if name != "matchid"])
def test_every_format_is_asked_alike(name: str, tmp_path: Path) -> None:
    made = FORMATS[name]
    (file,) = write_rig_files(
        tmp_path / f"rig{made.suffixes[0]}", made, made.write(Rig.of({"a": camera()}), ""), force=False
    )
    text = file.read_text()
    assert "702.0" in text
    file.write_text(text.replace("702.0", "1e15"))
    with pytest.raises(InputError, match="focal length"):
        read_rig_files([file], name)


def test_a_camera_that_could_not_be_read_back_is_not_written() -> None:
    wild = Camera(np.diag([1e9, 1e9, 1.0]), "pinhole", np.zeros(5), np.eye(4), (640, 480))
    with pytest.raises(InputError, match="focal length"):
        CameraRecord.of(wild)


def test_long_lenses_have_large_coefficients_and_wide_ones_fold_in_the_corners(tmp_path: Path) -> None:
    long = Camera(
        np.array([[50_000.0, 0.0, 320.0], [0.0, 50_000.0, 240.0], [0.0, 0.0, 1.0]]),
        "brown5", np.array([-2.0, 5e3, 0.0, 0.0, 1e8]), np.eye(4), (640, 480),
    )  # fmt: skip
    wide = np.array([[300.0, 0.0, 320.0], [0.0, 300.0, 240.0], [0.0, 0.0, 1.0]])
    folding = Camera(wide, "brown-k1k2", np.array([-0.25, 0.0, 0.0, 0.0, 0.0]), np.eye(4), (640, 480))
    with pytest.raises(InputError, match="folds within its picture"):
        require_rays_everywhere("wide", folding)
    write_rig(tmp_path / "rig.json", Rig.of({"long": long, "wide": folding}))
    assert list(read_rig(tmp_path / "rig.json").cameras) == ["long", "wide"]


@pytest.mark.parametrize("vanishing", [1e-300, 1e-160, 5e-324])
def test_a_coefficient_that_is_next_to_nothing_is_nothing(vanishing: float) -> None:
    """The root of its polynomial is no number."""
    found = camera([-0.1, vanishing, 0.0, 0.0, vanishing])
    q = np.array([[10.0, 20.0], [600.0, 400.0]])
    expected = camera([-0.1, 0.0, 0.0, 0.0, 0.0]).rays(q).direction
    np.testing.assert_allclose(found.rays(q).direction, expected, rtol=0, atol=1e-12)
